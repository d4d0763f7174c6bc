"""Draws the figures of "Human Motion Simulation and Action Corpus" anew: 1(b), 1(c), 5(a), 5(b) and 5(c).

python examples/actionlet_figures.py FOLDER [WALK.bvh]

Needs the extra [report] for SVG. The measured curve of 1(b) is that of a hip in WALK.bvh, a clip that ships
with gmr where none is given. The run is one stride: the knee flexes far in swing (AB), extends (BC), gives
way under the body (CD) and extends again (DE); the hip follows with the same period.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import vl_convert
from numpy.typing import NDArray

import gmr
from gmr.actionlets import Actionlet, Score, Track, synchronise
from gmr.demo import demo_folder
from gmr.pages import Figure
from gmr.table import Table

FPS = 3000
PERIOD = 0.68
KNEE = [(0.0, 14.0), (0.23, 98.0), (0.43, 12.0), (0.54, 41.0), (PERIOD, 14.0)]
HIP = [(0.0, -18.0), (0.36, 52.0), (PERIOD, -18.0)]
AHEAD = 0.09  # seconds from A, where the knee begins to flex, back to X, where the hip does

SOLID, DOTTED = [1, 0], [2, 4]


def main() -> None:
    folder = Path(sys.argv[1])
    walk = Path(sys.argv[2]) if len(sys.argv) > 2 else demo_folder() / "07_01.bvh"
    folder.mkdir(parents=True, exist_ok=True)
    for figure in (measured(walk), simulated(), knee_alone(), synchronised(), mutated()):
        path = folder / f"{figure.name}.svg"
        path.write_text(vl_convert.vegalite_to_svg(figure.description()), encoding="utf-8")
        print(f"{path}: {figure.title}")


def measured(walk: Path) -> Figure:
    """1(b): the velocity of a joint between two instants of rest, and that of the actionlet which fits it."""
    found = gmr.actionlets.decompose(gmr.read(walk), joints=["LeftUpLeg", "RightUpLeg", "LeftForeArm"])
    dof, place = max(
        (
            (dof, place)
            for dof, track in found.score.tracks.items()
            for place in range(1, len(track.pieces) - 1)
        ),
        key=lambda at: typical(found.score[at[0]], at[1]),
    )
    track = found.score[dof]
    begin, end = track.times[place : place + 2]
    frames = found.recorded.times
    shown = (frames >= begin - 0.05) & (frames <= end + 0.05)
    slope = smoothed_slope(found.recorded.angles[:, found.recorded.dofs.index(dof)], found.recorded.fps)
    fine = np.linspace(begin, end, 200)
    lines = {
        "measured": (frames[shown] - begin, np.degrees(slope[shown])),
        "actionlet": (fine - begin, np.degrees(track.velocity(fine))),
    }
    piece = track.pieces[place]
    sentence = (
        f"{dof} of {walk.stem} from {np.degrees(piece.start):.0f}° to {np.degrees(piece.end):.0f}° in"
        f" {piece.duration:.2f} s, and the actionlet that fits it."
    )
    return drawn("actionlet_measured", "Velocity as measured", sentence, lines, "degrees a second")


def smoothed_slope(angles: NDArray[np.float64], fps: float) -> NDArray[np.float64]:
    """Of the angles averaged over a tenth of a second (Hann): markers tremble."""
    window = np.hanning(round(0.1 * fps) + 2)[1:-1]
    half = len(window) // 2
    padded = np.pad(angles, (half, len(window) - 1 - half), mode="edge")
    return np.gradient(np.convolve(padded, window / window.sum(), mode="valid")) * fps


def typical(track: Track, place: int) -> float:
    """The way of a piece that turns round at both ends and is not jerked."""
    before, piece, after = track.pieces[place - 1 : place + 2]
    turns = before.travel * piece.travel < 0 and piece.travel * after.travel < 0
    even = isinstance(piece, Actionlet) and 0.2 < piece.skew < 0.8
    return piece.travel if turns and even else 0.0


def simulated() -> Figure:
    """1(c): two velocity curves of Eq. 1."""
    times = np.linspace(0, 1, 301)
    # The bell peaks at 1; the velocity of a way of 1 in 1 second is twice that.
    lines = {f"T = {T}": (times, Actionlet(0, 1, 1, T).velocity(times) / 2) for T in (0.3, 0.5)}
    sentence = "Two half cycles of a sine, the first as long as T says."
    return drawn("actionlet_bells", "Velocity of an actionlet", sentence, lines, "v(t)", "t")


def knee_alone() -> Figure:
    """5(a): two types of actionlets make the knee's joint action."""
    knee = track(KNEE)
    sentence = "Flexing (AB, CD) and extending (BC, DE), an actionlet each, at 3000 frames a second."
    return drawn(
        "actionlet_knee",
        "Knee in running",
        sentence,
        {"knee": angles(knee)},
        "degrees",
        marks=letters(knee, "ABCDE"),
    )


def synchronised() -> Figure:
    """5(b): knee and hip of a leg share the period and differ in phase."""
    knee = track(KNEE)
    hip = synchronise(Score({"hip": track(HIP)}), phase=AHEAD)["hip"]
    # X is shown where the hip's period began, before A.
    whole = Track((*track(HIP).pieces,))
    times, values = angles(whole)
    lines = {"knee": angles(knee), "hip": (times - AHEAD, values)}
    marks = letters(knee, "ABCDE") + [
        (time - AHEAD, angle, letter) for time, angle, letter in letters(whole, "XYZ")
    ]
    assert np.isclose(float(hip.angle(0.0)), float(whole.angle(AHEAD)))
    sentence = f"Their phases differ by |A - X| = {AHEAD:.2f} s, their periods |E - A| and |Z - X| are equal."
    return drawn("actionlet_knee_and_hip", "Knee and hip in running", sentence, lines, "degrees", marks=marks)


def mutated() -> Figure:
    """5(c): the same joint action of other velocity functions."""
    lines = {f"T = {T}": angles(track(KNEE, T)) for T in (0.3, 0.5)}
    sentence = "The same extremes at the same times; all actionlets of T = 0.3, and all of T = 0.5."
    return drawn("actionlet_mutation", "Mutation of the knee", sentence, lines, "degrees")


def track(extremes: list[tuple[float, float]], skew: float = 0.45) -> Track:
    return Track.through([(time, np.radians(degrees), skew) for time, degrees in extremes])


def angles(track: Track) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    times = np.arange(int(track.duration * FPS) + 1) / FPS
    return times, np.degrees(track.angle(times))


def letters(track: Track, names: str) -> list[tuple[float, float, str]]:
    return list(zip(track.times.tolist(), np.degrees(track.extremes).tolist(), names, strict=True))


def drawn(
    name: str,
    title: str,
    sentence: str,
    lines: dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]],
    unit: str,
    axis: str = "seconds",
    marks: list[tuple[float, float, str]] | None = None,
) -> Figure:
    names = list(lines)
    line: dict[str, Any] = {
        "data": {"name": "lines"},
        "mark": {"type": "line", "strokeWidth": 2.2},
        "encoding": {
            "color": {
                "field": "line", "type": "nominal", "sort": names, "title": None,
                "scale": {"domain": names, "range": ["var(--kind-0)", "var(--reference)"][: len(names)]},
                "legend": {"symbolType": "stroke", "symbolStrokeWidth": 2.2} if len(names) > 1 else None,
            },
            "strokeDash": {
                "field": "line", "sort": names, "legend": None,
                "scale": {"domain": names, "range": [SOLID, DOTTED][: len(names)]},
            },
        },
    }  # fmt: skip
    dot = {
        "data": {"name": "marks"},
        "mark": {"type": "point", "filled": True, "size": 46, "color": "var(--ink)"},
    }
    letter = {
        "data": {"name": "marks"},
        "mark": {"type": "text", "dy": -13, "fontSize": 14, "fontStyle": "italic"},
        "encoding": {"text": {"field": "letter"}},
    }
    data = {
        "lines": Table(
            {
                "x": np.concatenate([x for x, _ in lines.values()]),
                "y": np.concatenate([y for _, y in lines.values()]),
                "line": np.repeat(names, [len(x) for x, _ in lines.values()]).astype(object),
            }
        )
    }
    if marks:
        times, values, named = zip(*marks, strict=True)
        data["marks"] = Table({"x": times, "y": values, "letter": np.array(named, object)})
    chart = {
        "width": "container",
        "height": 300,
        "layer": [line, dot, letter] if marks else [line],
        "encoding": {
            "x": {
                "field": "x",
                "type": "quantitative",
                "title": axis,
                "axis": {"grid": False, "tickCount": 8},
            },
            "y": {"field": "y", "type": "quantitative", "title": unit, "axis": {"tickCount": 6}},
        },
    }
    return Figure(name, title, sentence, chart, data)


if __name__ == "__main__":
    main()
