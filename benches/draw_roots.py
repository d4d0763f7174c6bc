"""Repeats the experiment of the General Motion Representation: draws its curve, prints its tables.

python benches/draw_roots.py docs/images/roots.svg            all of it, some minutes
python benches/draw_roots.py /tmp/roots.svg --rounds 1 --every 5

For k = 1 to 26 roots, ten random sets each: the time per frame to compute the positions of all joints of
37 recordings, with BVH in turn beside it. Each set counts by the median over its rounds. The line is the
median over the sets, the band goes from the quickest to the slowest; BVH's band from the quickest tenth
of all its medians to the slowest. See gmr.bench.roots.
"""

from __future__ import annotations

import argparse
import json
import statistics
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import vl_convert

import gmr
from gmr.bench.harness import one_core
from gmr.bench.inputs import cmu_like_bvh
from gmr.bench.roots import EULER_ROWS, QUATERNIONS, SETS, Recordings, Work, random_roots, record
from gmr.formats.gmr import gmr_chunks

GMR = "GMR, k roots"
COLOURS = {EULER_ROWS: "#c0392b", QUATERNIONS: "#c8711a", GMR: "#2a6ea9"}

Point = dict[str, Any]


def measured(recordings: Recordings, rounds: int, every: int) -> list[Point]:
    """Nanoseconds a frame for each k: those of GMR with their spread over the sets, and BVH's beside them.

    One set of each k after the other, so that a slow minute of the machine is no single k's.
    """
    bvh = {EULER_ROWS: recordings.from_euler_rows(), QUATERNIONS: recordings.from_quaternions()}
    count = recordings.joint_count
    sets = {k: random_roots(count, k) for k in sorted({*range(1, count + 1, every), count})}
    costs: dict[int, dict[str, list[float]]] = {k: {name: [] for name in COLOURS} for k in sets}
    for number in range(SETS):
        for k in sets:
            calls = {**bvh, GMR: recordings.from_roots(sets[k][number])}
            for name, seconds in _timed(calls, rounds).items():
                costs[k][name].append(1e9 * seconds / recordings.frame_count)
    return [
        {"k": k, "what": name, "sets": found, "cost": statistics.median(found)}
        | {"low": min(found), "high": max(found)}
        for k in sets
        for name, found in costs[k].items()
    ]


def _timed(calls: Mapping[str, Work], rounds: int) -> dict[str, float]:
    """The median of each call's times, taken turn by turn."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for call in calls.values():
        call()
    for _ in range(rounds):
        for name, call in calls.items():
            begun = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - begun)
    return {name: statistics.median(found) for name, found in times.items()}


def chart(points: Sequence[Point]) -> dict[str, Any]:
    """Vega-Lite description of the curve, on white so that it can be read where a page is dark."""
    colour = {
        "field": "what",
        "type": "nominal",
        "title": None,
        "scale": {"domain": list(COLOURS), "range": list(COLOURS.values())},
        "legend": {
            "orient": "top",
            "labelLimit": 300,
            "symbolType": "stroke",
            "symbolStrokeWidth": 3,
            "symbolOpacity": 1,
            "columnPadding": 24,
        },
    }
    last = max(point["k"] for point in points)
    axis = {
        "field": "k", "type": "quantitative", "title": f"roots, of {last} joints",
        "scale": {"domain": [0, last], "nice": False},
    }  # fmt: skip
    highest = max(point["high"] for point in [*levels(points), *points])
    scale = {"domain": [0, 1.06 * highest], "nice": False}
    cost = {"type": "quantitative", "title": "nanoseconds a frame", "scale": scale}
    return {
        "$schema": "https://vega.github.io/schema/vega-lite/v5.json",
        "width": 560,
        "height": 300,
        "background": "white",
        "padding": 14,
        "title": {"text": "Positions of every joint: what a frame costs", "anchor": "start", "fontSize": 15},
        "config": {"font": "sans-serif", "axis": {"labelFontSize": 12, "titleFontSize": 13}},
        "data": {"values": [point for point in points if point["what"] == GMR] + levels(points)},
        "encoding": {"x": axis, "color": colour},
        "layer": [
            {
                "mark": {"type": "area", "opacity": 0.22},
                "encoding": {"y": {**cost, "field": "low"}, "y2": {"field": "high"}},
            },
            {"mark": {"type": "line", "strokeWidth": 2.2}, "encoding": {"y": {**cost, "field": "cost"}}},
        ],
    }


def levels(points: Sequence[Point]) -> list[Point]:
    """BVH's lines, which do not depend on k: medians, with bands from the lowest tenth to the highest."""
    ends = [min(point["k"] for point in points), max(point["k"] for point in points)]
    found = []
    for name in (EULER_ROWS, QUATERNIONS):
        costs = [cost for point in points if point["what"] == name for cost in point["sets"]]
        low, *_, high = statistics.quantiles(costs, n=10)
        level = {"what": name, "cost": statistics.median(costs), "low": low, "high": high}
        found += [{"k": k, **level} for k in ends]
    return found


def table(points: Sequence[Point]) -> Iterator[str]:
    """Lines of a Markdown table of some of the curve's points."""
    by_k: dict[int, Mapping[str, Point]] = {}
    for point in points:
        by_k[point["k"]] = {**by_k.get(point["k"], {}), point["what"]: point}
    last = max(by_k)
    yield "| roots | ns a frame (quickest to slowest set) | BVH from Euler rows | BVH from quaternions |"
    yield "|---|---|---|---|"
    for k in sorted(by_k):
        if k in (1, 7, 13, 19, 22, 24, 25, last):
            found = by_k[k]
            mine = found[GMR]
            ratios = (_ratio(found[name], mine) for name in (EULER_ROWS, QUATERNIONS))
            spread = f"{mine['cost']:.0f} ({mine['low']:.0f} to {mine['high']:.0f})"
            yield f"| {k} | {spread} | {' | '.join(ratios)} |"


def _ratio(bvh: Point, mine: Point) -> str:
    """The median of the ratios, each of times that were taken in turn."""
    ratios = [theirs / ours for theirs, ours in zip(bvh["sets"], mine["sets"], strict=True)]
    return f"{statistics.median(ratios):.1f}x ({min(ratios):.1f} to {max(ratios):.1f})"


def sizes(recordings: Recordings) -> Iterator[str]:
    """Lines of a Markdown table of the bytes that a frame takes in memory, and in a text .gmr."""
    full, lean = recordings.bvh[0], recordings.lean[0]
    rows = full.rows.shape[1]
    bvh = len(cmu_like_bvh().partition(b"Frame Time:")[2]) / 36_088
    yield "| what | numbers a frame | float64 | float32 | text `.gmr` |"
    yield "|---|---|---|---|---|"
    yield f"| BVH text | {rows} | {bvh:.0f} bytes of text | | |"
    yield f"| BVH rows, as read | {rows} | {8 * rows} | | {text(full):.0f} |"
    quaternions = replace(full, source=replace(full.pose, layout=None, rows=None))
    yield _size("BVH as quaternions, with dummies", numbers(full), text(quaternions))
    for name, motion in (("with dummies", quaternions), ("without", lean)):
        count = motion.skeleton.joint_count
        for k in (1, (count + 1) // 2, count):
            found = [motion.with_roots(roots) for roots in random_roots(count, k)]
            mean = statistics.mean(map(numbers, found)), statistics.mean(map(text, found))
            yield _size(f"GMR C_{k}, {count} joints, {name}", *mean)
    yield _size("positions alone: all that C_26 reads for them", 3 * lean.skeleton.joint_count)


def numbers(motion: gmr.Motion) -> int:
    """Numbers that a frame of the motion's pose takes."""
    return 4 * motion.skeleton.slot_count + 3 * len(motion.translated)


def text(motion: gmr.Motion) -> float:
    """Bytes that a frame of the motion takes in a text .gmr."""
    written = b"".join(map(bytes, gmr_chunks(motion)))
    return len(written.partition(b"Frame Time:")[2].partition(b"\n")[2]) / motion.frame_count


def _size(what: str, count: float, text: float | None = None) -> str:
    said = "" if text is None else f"{text:.0f}"
    return f"| {what} | {count:.0f} | {8 * count:.0f} | {4 * count:.0f} | {said} |"


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    options.add_argument("picture", type=Path)
    options.add_argument("--rounds", type=int, default=5)
    options.add_argument("--every", type=int, default=1, help="measure every so many k only")
    asked = options.parse_args()
    recordings = record()
    with one_core():
        points = measured(recordings, asked.rounds, asked.every)
    print(f"{recordings.frame_count:,} frames, {recordings.joint_count} joints, {recordings.source}\n")
    print("\n".join(table(points)), end="\n\n")
    print("\n".join(sizes(recordings)))
    asked.picture.write_text(vl_convert.vegalite_to_svg(json.dumps(chart(points))), encoding="utf-8")


if __name__ == "__main__":
    main()
