"""Travel: from planned angles and contacts to a body that walks, runs and jumps.

:func:`carried` is all that is needed: it takes sampled angles and a plan (contacts, speed, turn rate) and
gives back corrected angles, the root and a report.
"""

from gmr.actionlets.travel.carry import Carried, carried
from gmr.actionlets.travel.plan import Plan, Planned
from gmr.actionlets.travel.report import FlightFound, Report, StanceFound

__all__ = ["Carried", "FlightFound", "Plan", "Planned", "Report", "StanceFound", "carried"]
