"""Finds, in a folder of BVH files, the moment at which a foot moves fastest.

python examples/fastest_foot.py FOLDER [LEFT_FOOT RIGHT_FOOT]
"""

import sys

import numpy as np

import gmr


def main() -> None:
    folder, *feet = sys.argv[1:]
    for name, motion in gmr.read_folder(folder).items():
        positions = motion.positions(joints=feet or ["LeftFoot", "RightFoot"])  # (F, 2, 3)
        speeds = np.linalg.norm(np.diff(positions, axis=0), axis=2) * motion.fps  # (F - 1, 2)
        frame, foot = np.unravel_index(speeds[1:].argmax(), speeds[1:].shape)
        side = ("left", "right")[foot]
        print(f"{name}: {side} foot, {speeds[1:].max():.1f} units/s at {(frame + 1) / motion.fps:.2f} s")


if __name__ == "__main__":
    main()
