"""The rotation of arrows along the axes, and outlines of support polygons."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.scene.arrows import turn_x_to
from dogbot_logtool.core.scene.support_scene import (
    BARELY_STABLE,
    NO_MARGIN,
    SAFE_MARGIN_M,
    STABLE,
    UNSTABLE,
    margin_colour,
    outlines,
)
from dogbot_logtool.core.stability import hulls
from tests.oracles.frames import turn_of
from tests.truth.geometry import hull


@pytest.mark.parametrize("beside", [0.0, 1e-20, 1e-100, 1e-170, 5e-324, 1e-6, 0.6])
@pytest.mark.parametrize("end", [1.0, -1.0])
def test_arrows_point_along_their_force_however_near_the_axis(end: float, beside: float) -> None:
    along = end * math.sqrt(1.0 - beside**2)
    directions = np.array([(along, beside, 0.0), (along, 0.0, -beside)])
    for direction, quaternion in zip(directions, turn_x_to(directions), strict=True):
        assert math.hypot(*quaternion) == pytest.approx(1.0, abs=1e-15)
        assert turn_of(quaternion)[:, 0] == pytest.approx(direction, abs=1e-15)
        assert quaternion[0] == 0.0  # it does not roll


def test_colours_of_margins() -> None:
    margins = np.array([-1.0, 0.0, 1e-12, SAFE_MARGIN_M / 2, SAFE_MARGIN_M, 1.0, np.nan])
    halfway = [(a + b) / 2 for a, b in zip(BARELY_STABLE, STABLE, strict=True)]
    wanted = [UNSTABLE, UNSTABLE, BARELY_STABLE, halfway, STABLE, STABLE, NO_MARGIN]
    np.testing.assert_allclose(margin_colour(margins), wanted, rtol=1e-6)


coordinates = st.integers(-3, 3).map(float)
NOWHERE = (math.nan, math.nan)


@given(st.lists(st.none() | st.tuples(coordinates, coordinates), min_size=1, max_size=6))
def test_outlines_are_what_gift_wrapping_gives(places: list[tuple[float, float] | None]) -> None:
    points: Floats = np.array([[(*(place or NOWHERE), 7.0) for place in places]])
    points[np.isnan(points[:, :, 0])] = np.nan
    outline = outlines(points, hulls(points[:, :, :2]))[0]
    told = [(x, y) for x, y, _ in outline.tolist() if not math.isnan(x)]
    corners = hull([*{place for place in places if place is not None}])
    if len(corners) < 2:
        assert told == []
    elif len(corners) == 2:
        assert sorted(told) == sorted(corners)
    else:
        assert (told[0], told[:-1]) == (told[-1], corners)
