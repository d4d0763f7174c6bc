"""Drives a character along a slalom and writes where its joints are, frame by frame, as one NumPy file.

python examples/drive_a_character.py FOLDER poses.npz
"""

import sys

import numpy as np

import gmr
from gmr.matching import Database, Profile, Segment, run_trials, trial_positions


def main() -> None:
    folder, out = sys.argv[1:]
    database = Database.build(gmr.read_folder(folder), mirror=True)
    turns = [Segment(2.0, 1.2, turn) for turn in (0.0, 0.5, -0.5, 0.5, -0.5)]  # s, m/s, radians/s
    log = run_trials(database, [Profile(tuple(turns))])
    poses = trial_positions(database, log, 0)  # (T, J, 3), metres

    names = np.array(database.skeleton.names)
    np.savez_compressed(out, positions=poses, parents=database.skeleton.parents, names=names)
    played = sorted({database.clip_names[database.clips[row]] for row in log.row[0]})
    print(f"{len(poses)} frames at {log.rate:g} per second, played from {', '.join(played)}")


if __name__ == "__main__":
    main()
