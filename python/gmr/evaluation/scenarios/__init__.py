"""Scenarios: what a character is asked to do, as a name and a list of trials.

The paper's two, constant and switching, ask for every cell of a grid of speeds and turn rates. The others ask
for single paths: standing, walking and standing again; weaving to left and right; going sideways and
backwards; random smooth paths; the points of a file. Whatever has a ``name`` and ``trials()`` is a scenario.
"""

from __future__ import annotations

from gmr.evaluation.scenarios.asked import asked_trials, scenarios_of
from gmr.evaluation.scenarios.on_grid import OnGrid, on_grid
from gmr.evaluation.scenarios.path_points import PathPoints
from gmr.evaluation.scenarios.protocol import Scenario
from gmr.evaluation.scenarios.slalom import Slalom
from gmr.evaluation.scenarios.splines import Splines
from gmr.evaluation.scenarios.start_stop import StartStop
from gmr.evaluation.scenarios.strafe import Strafe

__all__ = [
    "OnGrid",
    "PathPoints",
    "Scenario",
    "Slalom",
    "Splines",
    "StartStop",
    "Strafe",
    "asked_trials",
    "on_grid",
    "scenarios_of",
]
