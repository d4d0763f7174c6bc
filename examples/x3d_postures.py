"""Cuts six postures A to F from a run, where a knee turns back; writes each as X3D, and all as one picture.

python examples/x3d_postures.py RUN.bvh FOLDER

RUN may be any motion of a run, recorded or synthesised. After Figures 4 and 5 of Zheng et al., "Human Motion
Simulation and Action Corpus".
"""

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import gmr
from gmr.body.joints import find_joints
from gmr.body.measures import path
from gmr.guesses import guess_body
from gmr.tpose import without_leading_tpose

Floats = NDArray[np.float64]

LETTERS = "ABCDEF"
LEAST_DEG = 8.0  # by which a knee must turn back for its angle to have been an extreme


def leg_angles(motion: gmr.Motion) -> tuple[Floats, Floats]:
    """(F,) degrees: how far the right knee is bent, and the right thigh raised forward."""
    positions = motion.positions(dtype=np.float64)
    roles = find_joints(motion.skeleton, positions).roles
    joints = path(motion.skeleton, roles["right_up_leg"], roles["right_foot"])
    hip, knee, ankle = positions[:, joints[0]], positions[:, joints[1]], positions[:, joints[-1]]
    thigh, shin = knee - hip, ankle - knee
    left = positions[:, roles["left_up_leg"]] - hip
    forward = np.cross(left, [0.0, 1.0, 0.0])
    forward /= np.linalg.norm(forward, axis=1, keepdims=True)
    straight = (thigh * shin).sum(axis=1) / np.linalg.norm(thigh, axis=1) / np.linalg.norm(shin, axis=1)
    raised = np.arctan2((thigh * forward).sum(axis=1), -thigh[:, 1])
    return np.degrees(np.arccos(np.clip(straight, -1, 1))), np.degrees(raised)


def extremes(angle: Floats) -> list[int]:
    """Frames in which a curve turns back by more than LEAST_DEG, in order."""
    found: list[int] = []
    best = sign = 0
    for frame, value in enumerate(angle):
        if sign == 0 and abs(value - angle[0]) > LEAST_DEG:
            sign, best = int(np.sign(value - angle[0])), frame
        elif sign * (value - angle[best]) > 0:
            best = frame
        elif sign and sign * (angle[best] - value) > LEAST_DEG:
            found.append(best)
            sign, best = -sign, frame
    return found


def picture(motion: gmr.Motion, knee: Floats, hip: Floats, frames: list[int]) -> str:
    """SVG: the six postures from the left, and below them the curves with their marks."""
    positions = motion.positions(dtype=np.float64)
    roles = find_joints(motion.skeleton, positions).roles
    low, high = positions[..., 1].min(), positions[..., 1].max()
    scale = 150 / (high - low)
    parts = []
    for k, frame in enumerate(frames):
        pose = positions[frame]
        left = pose[roles["left_up_leg"]] - pose[roles["right_up_leg"]]
        forward = np.cross(left, [0.0, 1.0, 0.0]) / np.linalg.norm(left[[0, 2]])
        across = 80 + 110 * k + scale * ((pose - pose[roles["hips"]]) @ forward)
        down = 180 - scale * (pose[:, 1] - low)
        for joint, parent in enumerate(motion.skeleton.parents.tolist()):
            if parent >= 0:
                start = f'x1="{across[parent]:.1f}" y1="{down[parent]:.1f}"'
                end = f'x2="{across[joint]:.1f}" y2="{down[joint]:.1f}"'
                name = motion.skeleton.names[joint].lower()
                colour = "#d9771f" if name.startswith(("r", "right")) else "#555"
                parts.append(
                    f'<line {start} {end} stroke="{colour}" stroke-width="3" stroke-linecap="round"/>'
                )
        parts.append(f'<text x="{80 + 110 * k}" y="200" text-anchor="middle">{LETTERS[k]}</text>')
    across = 30 + 640 * np.arange(len(knee)) / max(len(knee) - 1, 1)
    for angle, label, colour in ((knee, "right knee", "#2b6cb0"), (hip, "right hip", "#2f855a")):
        down = 370 - 1.1 * (angle + 30)
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, down, strict=True))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="2"/>')
        parts.append(f'<text x="{across[-1] + 6:.1f}" y="{down[-1]:.1f}" fill="{colour}">{label}</text>')
        for k, frame in enumerate(frames):
            parts.append(f'<circle cx="{across[frame]:.1f}" cy="{down[frame]:.1f}" r="3" fill="{colour}"/>')
            if angle is knee:
                parts.append(f'<text x="{across[frame]:.1f}" y="{down[frame] - 8:.1f}">{LETTERS[k]}</text>')
    style = "font-family: sans-serif; font-size: 13px; background: white"
    body = "\n".join(parts)
    return f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 400" style="{style}">\n{body}\n</svg>\n'


def main() -> None:
    run, folder = sys.argv[1], Path(sys.argv[2])
    motion = without_leading_tpose(gmr.read(run))
    unit = guess_body(motion).unit
    if motion.unit is None and unit is not None:
        print(f"{run}: taken to be in {unit.name}")
        motion = motion.with_unit(unit.metres)
    knee, hip = leg_angles(motion)
    frames = extremes(knee)[: len(LETTERS)]
    if len(frames) < len(LETTERS):
        sys.exit(f"{run}: the knee turns back {len(frames)} times, six are needed; give a longer run")
    folder.mkdir(parents=True, exist_ok=True)
    for letter, frame in zip(LETTERS, frames, strict=True):
        gmr.write(motion[frame : frame + 1], folder / f"posture_{letter}.x3d")
        seconds = frame * motion.frame_time
        print(f"{letter}: {seconds:.2f} s, knee {knee[frame]:.0f}, hip {hip[frame]:.0f} degrees")
    (folder / "postures.svg").write_text(picture(motion, knee, hip, frames))


if __name__ == "__main__":
    main()
