"""Which gait it is, and how sure that is, in words."""

import math
from typing import Final

from dogbot_logtool.core.checks.wording import counted
from dogbot_logtool.core.gait.classes import BIPED, HEXAPOD, IRREGULAR, QUADRUPED, STAND, TOLERANCE
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.statistics import Stats

FEWEST_STRIDES: Final = 3
"""Strides from which phases can be consistent."""


def headline(stats: Stats) -> str:
    """Name the gait of the longest segment in a few words; before that, when the robot falls."""
    name, fall = gait_headline(stats), fall_headline(stats)
    return f"{fall}; {name.lower()}" if fall else name


def gait_headline(stats: Stats) -> str:
    """Name the gait of the longest segment, and how sure that is."""
    main = stats.main
    if main is None:
        return "Gait not known"
    sure = how_sure(main)
    return f"{gait_name(main)}, {sure}" if sure else gait_name(main)


def fall_headline(stats: Stats) -> str:
    """``Falls at 8.02 s``, or that it tips over as the recording ends; empty if it does neither."""
    if not len(stats.fallen):
        found = stats.tipping
        at = "" if found is None else f"{(found.since - stats.origin) / 1e9:.2f} s"
        return f"Tips over from {at}, as the recording ends" if at else ""
    times = ", ".join(f"{at:.2f} s" for at in stats.seconds(stats.fallen[:3, 0]))
    return f"Falls at {times}"


def is_known(stats: Stats) -> bool:
    """Tell whether the gait has a name."""
    return stats.main is not None and stats.main.gait.name not in {None, IRREGULAR}


def gait_name(segment: Segment) -> str:
    """Name a gait as people do: ``Lateral-sequence walk``."""
    gait = segment.gait
    if segment.moves_without_steps:
        return "Moves without steps"
    if segment.is_lifted:
        return "No foot loaded"
    if gait.name is None:
        return "Gait not known"
    sequence = {"lateral": "lateral-sequence ", "diagonal": "diagonal-sequence "}
    prefix = sequence.get(gait.sequence or "", f"{gait.sequence} " if gait.sequence else "")
    return f"{prefix}{gait.name}".capitalize()


def how_sure(segment: Segment) -> str:
    """``clearly`` or ``fairly`` for a gait that phases of some strides name; empty for others."""
    gait = segment.gait
    if gait.name in {None, IRREGULAR, STAND} or gait.distance is None or not _consistency(segment):
        return ""
    if segment.strides < FEWEST_STRIDES:
        return "by few strides"
    sure = gait.distance <= TOLERANCE / 2.0 and min(_consistency(segment)) > 0.95
    return "clearly" if sure else "fairly"


def evidence(segment: Segment) -> str:
    """Say by what a gait was named."""
    gait, consistency = segment.gait, _consistency(segment)
    feet = len(segment.phases)
    if segment.moves_without_steps:
        return "the base moves and no foot steps: wheels, or wrong contacts"
    if segment.is_lifted:
        return "the robot is held in the air, or lies on its body"
    if feet not in {BIPED, QUADRUPED, HEXAPOD}:
        return f"only gaits of two, four or six feet have names; this robot has {feet}"
    if gait.name is None and len(consistency) == feet:
        return "which foot is front or back, left or right must be known to name one"
    if gait.name is None or gait.distance is None or not consistency:
        return f"phases of all {feet} feet are needed to name one"
    if gait.name == IRREGULAR:
        phases = f"nearest to {gait.nearest}: phases {gait.distance:.2f} cycles off"
    else:
        phases = f"phases within {gait.distance:.3f} cycles"
    strides = counted(segment.strides, "stride")
    return f"{phases}, R at least {_floor(min(consistency))}, {strides}"


def _consistency(segment: Segment) -> list[float]:
    return [phase.consistency for phase in segment.phases if phase is not None]


def _floor(share: float) -> str:
    """Two decimals, never rounded up."""
    return f"{math.floor(share * 100.0) / 100.0:.2f}"
