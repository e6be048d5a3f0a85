"""The way of a contact point counts from 10 % to 90 % of a stance, where the foot is loaded."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Flags, Floats
from dogbot_logtool.core.contact.contact_way import Ways, ways_under_load
from dogbot_logtool.core.contact.stance_samples import StanceSamples

TIME = np.linspace(-0.01, 1.0, 102)


def ways(x: Floats, loaded: Flags | None = None, *, single: bool = True) -> tuple[Ways, Ways]:
    """Of one stance of a second; the point lies on a line along x."""
    count = len(x)
    return ways_under_load(
        StanceSamples(
            first=np.array([0]),
            touchdown=np.array([1]),
            end=np.array([count - 1]),
            stance=np.zeros(count, np.int64),
            time=TIME,
            force=np.full(count, 100.0) if loaded is None else np.where(loaded, 100.0, 1.0),
            vector=np.zeros((count, 3)),
            point=x.astype(np.complex128),
            single=np.full(count, single),
            friction=np.zeros(count),
        ),
        np.array([100.0]),
    )


def moved(begins: float, ends: float, way_m: float = 0.03) -> Floats:
    return np.asarray(way_m * np.clip((TIME - begins) / (ends - begins), 0.0, 1.0))


@pytest.mark.parametrize(
    ("begins", "ends", "way_m"),
    [(0.01, 0.08, 0.0), (0.92, 0.99, 0.0), (0.45, 0.50, 0.03)],
    ids=["as it lands", "as it leaves", "in the middle"],
)
def test_a_foot_that_rolls_as_it_lands_or_leaves_has_no_way(
    begins: float, ends: float, way_m: float
) -> None:
    every, quick = ways(moved(begins, ends))
    assert every.metres == pytest.approx([way_m], abs=1e-9)
    assert quick.metres == pytest.approx([way_m], abs=1e-9)
    if way_m:
        assert every.begins_s == pytest.approx([begins], abs=0.011)
        assert quick.ends_s == pytest.approx([ends], abs=0.011)


def test_a_jump_without_load_is_no_way() -> None:
    x = np.where(TIME < 0.5, 0.0, 0.04) + moved(0.7, 0.8, 0.01)
    every, _ = ways(x, (TIME < 0.48) | (TIME > 0.52))
    assert every.metres == pytest.approx([0.01])


def test_jumps_and_means_of_several_points_are_no_quick_way() -> None:
    _, quick = ways(np.where(TIME < 0.5, 0.0, 0.05))
    assert quick.metres == pytest.approx([0.0])
    assert np.isnan(ways(moved(0.4, 0.5), single=False)[1].metres).all()
