"""Every kind of log that there is truth for."""

from inspect import getdoc, isgeneratorfunction
from itertools import chain
from typing import Final

from tests.truth import (
    event_cases,
    foot_cases,
    gait_cases,
    imu_cases,
    pose_cases,
    sensor_cases,
    time_cases,
)
from tests.truth.case import Case

_ALL: Final = gait_cases, sensor_cases, foot_cases, pose_cases, time_cases, event_cases, imu_cases


def groups() -> dict[str, tuple[Case, ...]]:
    """Return all cases by subject: the first sentence of the function that yields them."""
    made = [
        make
        for module in _ALL
        for name, make in vars(module).items()
        if isgeneratorfunction(make) and not name.startswith("_")
    ]
    return {(getdoc(make) or "").partition(".")[0]: tuple(make()) for make in made}


def all_cases() -> tuple[Case, ...]:
    """Return all cases, in the order of the page."""
    return tuple(chain.from_iterable(groups().values()))
