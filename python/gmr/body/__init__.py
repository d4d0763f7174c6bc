"""The body in a skeleton: its hips, legs and feet, which way is up, how long its legs are."""
