"""``python -m gmr``: the command line."""

from gmr.cli import main

if __name__ == "__main__":
    main()
