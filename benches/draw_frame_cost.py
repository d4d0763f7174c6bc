"""Measures the cost per frame of forward kinematics from 1,000 to 1,000,000 frames and draws the curve.

python benches/draw_frame_cost.py docs/images/frame_cost.svg
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import vl_convert

from gmr.bench import Row, run


def nanoseconds(rate: float) -> float:
    """Nanoseconds a frame at a rate in million frames a second."""
    return 1e3 / rate


def chart(rows: Sequence[Row]) -> dict[str, Any]:
    """Vega-Lite description of the curve with the spread over the rounds."""
    values = [
        {
            "frames": int(row.work.split(" of ")[1].split(" ")[0].replace(",", "")),
            "cost": nanoseconds(row.ours),
            "low": nanoseconds(row.ours_high),
            "high": nanoseconds(row.ours_low),
        }
        for row in rows
    ]
    frames = {
        "field": "frames",
        "type": "quantitative",
        "scale": {"type": "log"},
        "title": "frames in the clip",
    }
    scale = {"domain": [0, 1.2 * max(value["high"] for value in values)]}
    cost = {"field": "cost", "type": "quantitative", "title": "nanoseconds a frame", "scale": scale}
    return {
        "$schema": "https://vega.github.io/schema/vega-lite/v5.json",
        "width": 520,
        "height": 220,
        "background": "white",
        "data": {"values": values},
        "encoding": {"x": frames},
        "layer": [
            {"mark": {"type": "line", "color": "#2a6ea9"}, "encoding": {"y": cost}},
            {"mark": {"type": "point", "filled": True, "color": "#2a6ea9"}, "encoding": {"y": cost}},
            {
                "mark": {"type": "rule", "color": "#2a6ea9"},
                "encoding": {"y": {"field": "low", "type": "quantitative"}, "y2": {"field": "high"}},
            },
        ],
    }


def main() -> None:
    rows = list(run(["fk-frames"]))
    for row in rows:
        print(f"{row.work}: {nanoseconds(row.ours):.0f} ns a frame")
    Path(sys.argv[1]).write_text(vl_convert.vegalite_to_svg(json.dumps(chart(rows))), encoding="utf-8")


if __name__ == "__main__":
    main()
