"""cli."""


def main() -> None:
    """Entry point (to be written)."""
