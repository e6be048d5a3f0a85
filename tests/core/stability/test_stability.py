"""Static stability of a robot that stands, walks or is partly unknown, against its geometry."""

from collections.abc import Sequence

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Flags, Floats
from dogbot_logtool.core.base.poses import BaseHistory, Odometry, base_history
from dogbot_logtool.core.contact.foot_history import FootHistory
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.hulls import NEAR_NS
from dogbot_logtool.core.metrics import Stability
from dogbot_logtool.core.stability import (
    _unstable,
    stability,
)
from tests.core.load.feet import TROT, WEIGHT_N, foot, seconds, vertical

CORNERS = ((0.3, 0.15), (0.3, -0.15), (-0.3, 0.15), (-0.3, -0.15))
TIME = seconds(8.0)


def base(time: Floats = TIME) -> BaseHistory:
    count, still = len(time), np.zeros((len(time), 3))
    stamp = 1_000_000_000 + np.round(time * 1e9).astype(np.int64)
    level = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
    poses = Odometry(stamp, stamp, still + np.array([0.0, 0.0, 0.4]), level, still, still)
    return base_history(poses, TimeSource.HEADER)


def robot(
    forces: Sequence[Floats],
    heard: Flags | None = None,
    *,
    points: bool = True,
    com_offset_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Stability:
    """Measure a robot whose last foot is heard at some times, and may tell no contact points."""
    feet: list[FootHistory] = []
    for (x, y), force in zip(CORNERS, forces, strict=True):
        last = len(feet) == len(CORNERS) - 1
        rows = heard if last and heard is not None else np.ones(len(TIME), np.bool_)
        place = np.array([x, y, 0.0 if points or not last else np.nan])
        place = np.where(np.isnan(place).any(), np.nan, place)
        feet.append(foot(TIME[rows], force[rows], np.tile(place, (int(rows.sum()), 1))))
    found = stability(feet, base(), "+x", vertical_known=True, com_offset_m=com_offset_m)
    assert found is not None
    return found[0]


STANDING = [np.full(len(TIME), WEIGHT_N / 4.0)] * 4
TROTTING = [vertical(TIME, phase) for phase in TROT]


def test_a_robot_that_stands_has_the_margin_of_its_feet() -> None:
    found = robot(STANDING)
    assert found.static_margin_m is not None
    assert found.static_margin_m.mean == pytest.approx(0.15)
    assert found.unknown_fraction == pytest.approx(0.0)
    assert found.undefined_fraction == 0.0


def test_the_centre_of_mass_counts_where_it_is_known() -> None:
    found = robot(STANDING, com_offset_m=(0.0, 0.05, -0.1))
    assert found.static_margin_m is not None
    assert found.energy_margin_m is not None
    assert found.static_margin_m.mean == pytest.approx(0.10)
    assert found.energy_margin_m.mean == pytest.approx(np.hypot(0.10, 0.3) - 0.3)
    assert found.centre_of_pressure_left_m is not None
    assert found.centre_of_pressure_left_m.mean == pytest.approx(0.0, abs=1e-9)


def test_two_feet_down_are_undefined_not_unknown() -> None:
    """Each pair of a trot is down for 0.6 of the stride, so both are for 0.2 of it."""
    found = robot(TROTTING)
    assert found.undefined_fraction == pytest.approx(0.8, abs=0.03)
    assert found.unstable_fraction == 0.0
    assert found.unknown_fraction == pytest.approx(0.0, abs=0.01)


def test_a_silent_foot_is_unknown_not_undefined() -> None:
    found = robot(STANDING, (TIME < 2.0) | (TIME > 4.0))
    assert found.unknown_fraction == pytest.approx(0.25, abs=0.01)
    assert found.undefined_fraction == 0.0


def test_a_foot_that_stands_nowhere_is_unknown_while_it_is_down() -> None:
    assert robot(TROTTING, points=False).unknown_fraction == pytest.approx(0.6, abs=0.03)
    found = robot(STANDING, points=False)
    assert found.unknown_fraction == 1.0
    assert found.undefined_fraction is None
    assert found.static_margin_m is None


def test_an_instant_speaks_until_the_next_one_if_that_is_near() -> None:
    instants = np.cumsum([0, NEAR_NS, 2 * NEAR_NS, 2 * NEAR_NS + 1, NEAR_NS])
    found = _unstable(instants, np.array([0.1, -0.2, -0.3, -0.1, 0.2]))
    assert found.spans.tolist() == [instants[1:3].tolist(), instants[3:].tolist()]
    assert found.least_margin_m.tolist() == [-0.2, -0.1]
