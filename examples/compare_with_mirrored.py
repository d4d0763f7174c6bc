"""Does a dataset need its mirror images? Evaluates it with and without them and says what changes.

python examples/compare_with_mirrored.py FOLDER
"""

import sys

import gmr


def main() -> None:
    takes = gmr.read_folder(sys.argv[1])
    for mirror in (False, True):
        evaluation = gmr.evaluate(takes, mirror=mirror)
        trials = evaluation.tables()["trials"]
        print("with mirror images:" if mirror else "as recorded:")
        print(f"  {evaluation.verdict.headline}")
        print(f"  mean offset over the grid: {trials['offset_mean'].mean():.2f} m")


if __name__ == "__main__":
    main()
