"""Outlines of support polygons, and their colours; `test_convert_support.py` has the rest."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Floats
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
from tests.truth.margins import hull

NOWHERE = (math.nan, math.nan, math.nan)


def test_colours_of_margins() -> None:
    margins = np.array([-1.0, 0.0, 1e-12, SAFE_MARGIN_M / 2, SAFE_MARGIN_M, 1.0, np.nan])
    halfway = [(a + b) / 2 for a, b in zip(BARELY_STABLE, STABLE, strict=True)]
    wanted = [UNSTABLE, UNSTABLE, BARELY_STABLE, halfway, STABLE, STABLE, NO_MARGIN]
    np.testing.assert_allclose(margin_colour(margins), wanted, rtol=1e-6)


coordinates = st.integers(-3, 3).map(float)


@given(st.lists(st.none() | st.tuples(coordinates, coordinates), min_size=1, max_size=6))
def test_outlines_are_what_gift_wrapping_gives(places: list[tuple[float, float] | None]) -> None:
    points: Floats = np.array([[(*(place or NOWHERE[:2]), 7.0) for place in places]])
    points[np.isnan(points[:, :, 0])] = np.nan
    outline = outlines(points, hulls(points[:, :, :2]))[0]
    told = [(x, y) for x, y, _ in outline.tolist() if not math.isnan(x)]
    corners = hull([*{place for place in places if place is not None}])
    if len(corners) < 2:
        assert told == []
    elif len(corners) == 2:
        assert sorted(told) == sorted(corners)
    else:
        assert told[0] == told[-1]
        assert told[:-1] == corners
    assert set(outline[np.isfinite(outline[:, 2]), 2]) <= {7.0}
