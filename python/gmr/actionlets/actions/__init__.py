"""Actions: library files of units and extremes, performed as scores of actionlets, done by a body."""
