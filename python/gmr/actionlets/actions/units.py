"""What library files are made of, as read: joint, limb and group actions, actions and sequences of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from gmr.actionlets.actions.values import Value

__all__ = [
    "LEAN",
    "MOST_SECONDS",
    "SIDES",
    "ActionUnit",
    "Change",
    "Extreme",
    "Parameter",
    "Part",
    "Step",
    "Unit",
]

SIDES = ("left", "right")

MOST_SECONDS = 36_000.0
"""A performance lasts no longer."""

LEAN = "lean"
"""The angle from upright at which a body on a curve is in balance, positive to the left:
``atan(speed * turn rate / g)``."""


@dataclass(frozen=True, slots=True)
class Extreme:
    """Where a degree of freedom stands still for an instant between two actionlets.

    Args:
        phase: when, as a share of the period or duration.
        angle: where; degrees, metres for the root's lengths.
        skew: of the actionlet that ends here, in (0, 1).
    """

    phase: Value
    angle: Value
    skew: Value


@dataclass(frozen=True, slots=True)
class Part:
    """A unit within another: ``q(t) = p(rate * t + phase)``, its angles spread about their middle.

    Args:
        unit: its name.
        side: "left" or "right" for a unit that is written without a side, else "".
        phase: how far it is ahead, as a share of the period.
        rate: how often it comes in one period.
        scale: what its movement is multiplied with.
    """

    unit: str
    side: str = ""
    phase: float = 0.0
    rate: int = 1
    scale: float = 1.0


@dataclass(frozen=True, slots=True)
class Unit:
    """A joint, limb or group action.

    Args:
        kind: "joint", "limb" or "group".
        name: its name, one in all files.
        file: where it is written.
        joint: of a joint action, the joint that moves; without a side where it can be used for both.
        motions: of a joint action, the extremes by motion ("flexion", ...).
        parts: of a limb or group action, what it is made of.
    """

    kind: str
    name: str
    file: str
    joint: str = ""
    motions: Mapping[str, tuple[Extreme, ...]] = field(default_factory=dict)
    parts: tuple[Part, ...] = ()


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number that whoever performs an action chooses.

    Args:
        low, high: its range.
        default: what it is where nobody chooses.
        unit: "m/s", "deg/s", ...; empty for a plain number.
        about: what it is.
        sided: whether it changes its sign where left and right are exchanged.
    """

    name: str
    low: float
    high: float
    default: float
    unit: str = ""
    about: str = ""
    sided: bool = False


@dataclass(frozen=True, slots=True)
class Change:
    """What an action changes in one degree of freedom: other extremes, or those that it has, changed."""

    extremes: tuple[Extreme, ...] = ()
    scale: float = 1.0
    add: Value = field(default_factory=lambda: Value(0.0))
    phase: float = 0.0


@dataclass(frozen=True, slots=True)
class ActionUnit:
    """An action as its file writes it; ``gmr.actionlets.actions.action.Action`` is what is performed.

    Args:
        cyclic: whether it goes on (``span`` is its period), or is done once (``span`` is its duration).
        span: seconds.
        begins: the phase with which a performance begins.
        seconds: how long a performance is where nobody says.
        contacts: by "left" and "right", the phases between which the foot is on the ground.
        travel: "path": speed and turn rate are asked; "feet": the planted feet carry the root.
        labels: by name, between which phases.
        courses: by parameter, (seconds, factor) points; seconds below 0 count from the end.
        mirrored: whether left and right are exchanged.
    """

    name: str
    file: str
    about: str
    words: tuple[str, ...]
    aliases: tuple[str, ...]
    parameters: Mapping[str, Parameter]
    cyclic: bool
    span: Value
    begins: float
    seconds: float | None
    parts: tuple[Part, ...]
    changes: Mapping[str, Change]
    contacts: Mapping[str, tuple[tuple[Value, Value], ...]]
    travel: str
    labels: Mapping[str, tuple[Value, Value]]
    courses: Mapping[str, tuple[tuple[float, float], ...]]
    mirrored: bool

    @property
    def derived(self) -> tuple[str, ...]:
        """Numbers that follow from the parameters, and which curves may use like one: ``lean``, degrees."""
        return (LEAN,) if {"speed", "turn_rate"} <= set(self.parameters) else ()

    @property
    def sided(self) -> frozenset[str]:
        """Parameters and derived numbers that change their sign where left and right are exchanged."""
        return frozenset(p.name for p in self.parameters.values() if p.sided) | {*self.derived}


@dataclass(frozen=True, slots=True)
class Step:
    """One action of a sequence, how long, and with which parameters."""

    action: str
    seconds: float | None
    parameters: Mapping[str, float]
