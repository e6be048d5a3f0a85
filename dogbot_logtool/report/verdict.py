"""Which gait it is, and how sure that is, in words."""

import math

from dogbot_logtool.core.gait.gait import IRREGULAR, QUADRUPED, STAND, TOLERANCE
from dogbot_logtool.core.gait.segments import Segment
from dogbot_logtool.core.statistics import Stats


def headline(stats: Stats) -> str:
    """Name the gait of the longest segment in a few words."""
    main = stats.main
    if main is None:
        return "Gait not known"
    name = gait_name(main)
    return f"{name}, {sure}" if (sure := how_sure(main)) else name


def is_known(stats: Stats) -> bool:
    """Tell whether the gait has a name."""
    return stats.main is not None and stats.main.gait.name not in {None, IRREGULAR}


def gait_name(segment: Segment) -> str:
    """Name a gait as people do: ``Lateral-sequence walk``."""
    gait = segment.gait
    if gait.name is None:
        return "Gait not known"
    sequence = {"lateral": "lateral-sequence ", "diagonal": "diagonal-sequence "}
    prefix = sequence.get(gait.sequence or "", f"{gait.sequence} " if gait.sequence else "")
    return f"{prefix}{gait.name}".capitalize()


def how_sure(segment: Segment) -> str:
    """``clearly`` or ``fairly`` for a gait that the phases name; empty for any other."""
    gait = segment.gait
    if gait.name in {None, IRREGULAR, STAND} or gait.distance is None or not _consistency(segment):
        return ""
    sure = gait.distance <= TOLERANCE / 2.0 and min(_consistency(segment)) > 0.95
    return "clearly" if sure else "fairly"


def evidence(segment: Segment) -> str:
    """Say by what a gait was named."""
    gait, consistency = segment.gait, _consistency(segment)
    feet = len(segment.phases)
    if feet != QUADRUPED:
        return f"only gaits of four feet have names; this robot has {feet}"
    if gait.name is None or gait.distance is None or not consistency:
        return "phases of all four feet are needed to name one"
    if gait.name == IRREGULAR:
        phases = f"nearest to {gait.nearest}: phases {gait.distance:.2f} cycles off"
    else:
        phases = f"phases within {gait.distance:.3f} cycles"
    return f"{phases}, R at least {_floor(min(consistency))}, {segment.strides} strides"


def _consistency(segment: Segment) -> list[float]:
    return [phase.consistency for phase in segment.phases if phase is not None]


def _floor(share: float) -> str:
    """Two decimals, never rounded up."""
    return f"{math.floor(share * 100.0) / 100.0:.2f}"
