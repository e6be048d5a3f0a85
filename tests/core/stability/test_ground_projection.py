import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.foot_history import FootHistory, foot_history
from dogbot_logtool.core.corrections.clock import TimeSource
from dogbot_logtool.core.stability import (
    footprints,
    pressure_path,
)

MS = 1_000_000


def foot(force: Floats, x: Floats, y: float = 0.0, *, world: bool = True) -> FootHistory:
    """A foot that is sampled every 10 ms, with its contact point at x, y."""
    count = len(force)
    time = np.arange(1, count + 1, dtype=np.int64) * 10 * MS
    touching = force > 0.0
    hidden = np.where(touching, 0.0, np.nan)
    vertical = np.zeros((count, 3))
    vertical[:, 2] = force
    rule = ContactRule(10.0, 0.0, 0.02)
    return foot_history(
        Samples(
            foot=np.zeros(count, np.int64),
            log_time=time,
            stamp=time,
            in_contact=touching,
            force=vertical,
            in_world=np.zeros(count, np.bool_),
            points=touching.astype(np.int64),
            position=np.stack([x + hidden, y + hidden, hidden], axis=1),
            normal=np.zeros((count, 3)),
        ),
        rule,
        TimeSource.LOG,
        force_in_world=world,
    )


def test_a_footprint_a_stance_near_its_first_contact_point() -> None:
    force = np.tile(np.repeat([0.0, 50.0], 30), 3)
    # The contact point rolls 1 mm a sample; each stance is half a metre on.
    x = np.arange(180) // 60 * 0.5 + np.arange(180) % 60 * 0.001
    prints = footprints(foot(force, x))
    assert prints.time.tolist() == [310 * MS, 910 * MS, 1510 * MS]
    assert prints.point[:, 0] == pytest.approx([0.030, 0.530, 1.030], abs=0.005)


def test_a_stance_without_a_contact_point_has_no_footprint() -> None:
    force = np.tile(np.repeat([0.0, 50.0], 30), 2)
    x = np.zeros(120)
    x[:60] = np.nan
    assert footprints(foot(force, x)).time.tolist() == [910 * MS]


def test_the_centre_of_pressure_lies_between_the_feet_by_their_load() -> None:
    still = np.zeros(100)
    heavy, light = foot(np.full(100, 90.0), still, 1.0), foot(np.full(100, 30.0), still, -1.0)
    path = pressure_path([heavy, light])
    assert len(path.time) > 20
    assert path.point[:, 1] == pytest.approx(np.full(len(path.time), 0.5))


def test_no_centre_of_pressure_where_a_vertical_force_is_not_known() -> None:
    still = np.zeros(100)
    known, unknown = foot(np.full(100, 90.0), still), foot(np.full(100, 90.0), still, world=False)
    assert len(pressure_path([known, unknown]).time) == 0
    assert len(pressure_path([]).time) == 0
