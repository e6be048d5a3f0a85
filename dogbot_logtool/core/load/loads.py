"""How hard each foot presses, for plots and for the gait diagram."""

from collections.abc import Collection, Sequence
from dataclasses import replace
from enum import IntEnum
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_tracker import FootTracker
from dogbot_logtool.core.geometry.arrays import Flags, Floats, Ints, norms
from dogbot_logtool.core.geometry.blocks import picked
from dogbot_logtool.core.geometry.support_polygon import NEAR_NS
from dogbot_logtool.dataclass import dataclass

GRAVITY_MPS2: Final = 9.81
"""Standard in simulators (Gazebo's default world has 9.8)."""


class LoadState(IntEnum):
    """The state of knowledge of a foot."""

    STANCE = 0
    SWING = 1
    UNKNOWN = 2


@dataclass(frozen=True, slots=True)
class Loads:
    """The load on a foot at the time of each contact sample."""

    foot: Ints
    """(n,) index of the foot among the robot's feet."""
    log_time: Ints
    """(n,) ns."""
    stamp: Ints
    """(n,) ns."""
    in_contact: Flags
    """(n,) as the sensor reports it."""
    state: Ints
    """(n,) a `LoadState`, by contact detection."""
    force: Floats
    """(n,) N, magnitude; not finite where the recording is not."""
    body_weights: Floats
    """(n,) the force over the robot's weight; NaN when its mass is unknown."""


def body_weight_n(mass_kg: float | None) -> float | None:
    """Return the weight of a robot, N, or None when its mass is unknown."""
    return None if mass_kg is None else mass_kg * GRAVITY_MPS2


def foot_loads(samples: Samples, trackers: Sequence[FootTracker], weight_n: float | None) -> Loads:
    """Return the load of every sample.

    Args:
        samples: of any feet.
        trackers: of all feet, through these samples.
        weight_n: N, the robot's; None: not known.
    """
    force = norms(samples.force)
    return Loads(
        foot=samples.foot,
        log_time=samples.log_time,
        stamp=samples.time,
        in_contact=samples.in_contact,
        state=_states(samples, force, trackers),
        force=force,
        body_weights=force / (np.nan if weight_n is None else weight_n),
    )


def _states(samples: Samples, force: Floats, trackers: Sequence[FootTracker]) -> Ints:
    """(n,) `LoadState` of samples; unknown where a force that is told is not finite."""
    state = np.full(len(force), LoadState.UNKNOWN, np.int64)
    for foot, tracker in enumerate(trackers):
        told = np.isfinite(force) | (not tracker.has_force)
        rows = np.flatnonzero((samples.foot == foot) & told)
        known, down = tracker.contact_at(samples.log_time[rows])
        in_air_or_down = np.where(down, LoadState.STANCE, LoadState.SWING)
        state[rows] = np.where(known, in_air_or_down, LoadState.UNKNOWN)
    return state


def all_known_from(loads: Sequence[Loads], opening: int) -> int:
    """Return the log time by which every foot of these loads has had one, ns."""
    first = [each.log_time[np.unique(each.foot, return_index=True)[1]] for each in loads]
    return int(np.concatenate([[opening], *first]).max())


def opening_loads(loads: Loads, opening: int, new_feet: Collection[int]) -> Loads:
    """Return the first load of each foot at the log's first time, where it follows at once.

    Args:
        loads: of a batch.
        opening: ns, log time.
        new_feet: feet without a load before the batch.
    """
    feet, first = np.unique(loads.foot, return_index=True)
    first = first[np.isin(feet, list(new_feet))]
    lag = loads.log_time[first] - opening
    rows = first[(lag > 0) & (lag <= NEAR_NS)]
    time = np.full(len(rows), opening)
    return replace(picked(loads, rows), log_time=time, stamp=time)
