"""Records of what annotated logs say of events and gaits."""

from collections.abc import Mapping
from dataclasses import field
from enum import IntEnum
from typing import Final

from dogbot_logtool.dataclass import dataclass

UNKNOWN: Final = "unknown"
"""The gait between segments."""


class Level(IntEnum):
    """How much an event matters, as log panels filter it."""

    DEBUG = 1
    INFO = 2
    WARNING = 3
    ERROR = 4


@dataclass(frozen=True, slots=True)
class EventMessage:
    """An event for a log panel."""

    time: int
    """ns, its onset."""
    level: Level
    source: str
    """Name of the foot, or ``robot``."""
    text: str
    end: int = 0
    """ns."""
    is_step: bool = False
    """Whether it is a touchdown or a lift-off."""
    details: Mapping[str, str] = field(default_factory=dict)
    """Its details by name: ``type``, ``foot``, ``value``, ``unit``, ``code``."""


@dataclass(frozen=True, slots=True)
class GaitState:
    """The gait from a time on."""

    time: int
    """ns."""
    gait: str
    """Class, or `UNKNOWN`."""
    stride_frequency_hz: float
    """NaN where there are no strides; also the rest."""
    duty_factor: float
    phases: tuple[float, ...]
    """Cycles, of each foot."""
