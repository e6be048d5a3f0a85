"""The way of a contact point counts from 10 % to 90 % of a stance, where the foot is loaded."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.contact.contact_way import ways_under_load
from dogbot_logtool.core.contact.stance_samples import StanceSamples


def stance(x: Floats) -> StanceSamples:
    """One stance of a second with a constant load; the point lies on a line along x."""
    count = len(x)
    constant = np.full(count, 100.0)
    zero = np.zeros(count)
    return StanceSamples(
        first=np.array([0]),
        touchdown=np.array([1]),
        end=np.array([count - 1]),
        stance=np.zeros(count, np.int64),
        time=np.linspace(-0.01, 1.0, count),
        force=constant,
        vertical=constant,
        force_x=zero,
        force_y=zero,
        x=x,
        y=zero,
        single=np.ones(count, np.bool_),
        friction=zero,
    )


@pytest.mark.parametrize(
    ("begins", "ends", "way_m"),
    [(0.01, 0.08, 0.0), (0.92, 0.99, 0.0), (0.45, 0.55, 0.03)],
    ids=["as it lands", "as it leaves", "in the middle"],
)
def test_a_foot_that_rolls_as_it_lands_or_leaves_has_no_way(
    begins: float, ends: float, way_m: float
) -> None:
    time = np.linspace(-0.01, 1.0, 102)
    moved = 0.03 * np.clip((time - begins) / (ends - begins), 0.0, 1.0)
    every, quick = ways_under_load(stance(moved), np.array([100.0]))
    assert every.metres == pytest.approx([way_m], abs=1e-9)
    assert (quick.metres > 0.01).tolist() == [way_m > 0.0]
