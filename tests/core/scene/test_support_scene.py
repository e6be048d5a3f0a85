"""What `/support` shows of feet that are told one message at a time."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contact_rule import ContactRule
from dogbot_logtool.core.hulls import hulls
from dogbot_logtool.core.scene.support_scene import (
    BARELY_STABLE,
    NO_MARGIN,
    SAFE_MARGIN_M,
    STABLE,
    UNSTABLE,
    SupportScene,
    margin_colour,
    outlines,
    support_scene,
)
from tests.core.scene.drawn_feet import MS, NOWHERE, Point, foot_of

RULE = ContactRule(on_n=10.0, off_n=0.0, debounce_s=0.020)
SQUARE = ((1.0, 1.0, 0.1), (1.0, -1.0, 0.2), (-1.0, 1.0, 0.3), (-1.0, -1.0, 0.4))


def pose(time: int, x: float = 0.0, y: float = 0.0) -> Odometry:
    times = np.array([time], np.int64)
    nothing = np.zeros((1, 3))
    turn = np.array([[0.0, 0.0, 0.0, 1.0]])
    return Odometry(times, times + 5, np.array([[x, y, 0.6]]), turn, nothing, nothing)


def shown(
    *heard: tuple[int, Sequence[tuple[Point, float] | None]],
    base: tuple[float, float] = (0.0, 0.0),
    works: bool = True,
) -> SupportScene:
    """Return the scene at the last of some times, ms, at which the feet were heard."""
    feet = [
        foot_of(
            [(time, told[1], told[0]) for time, each in heard if (told := each[number])],
            RULE,
            number=number,
            contact_known=works,
        )
        for number in range(len(heard[0][1]))
    ]
    return support_scene(pose(heard[-1][0] * MS, *base), feet)


def corners(scene: SupportScene) -> list[list[float]]:
    outline = scene.outline[0]
    return [corner for corner in outline.tolist() if not math.isnan(corner[0])]


def test_four_feet() -> None:
    scene = shown((0, [(point, 50.0) for point in SQUARE]), base=(0.75, 0.0))
    assert corners(scene) == [list(SQUARE[row]) for row in (3, 1, 0, 2, 3)]
    assert (scene.margin[0], scene.unknown, scene.unweighed) == (0.25, 0, 0)
    np.testing.assert_allclose(scene.pressure, [[0.0, 0.0, 0.25]])
    np.testing.assert_allclose(scene.projection, [[0.75, 0.0, 0.25]])
    assert (scene.log_time.tolist(), scene.stamp.tolist()) == ([0], [5])


def test_two_feet_make_a_line_without_a_margin() -> None:
    down = [(SQUARE[0], 30.0), (SQUARE[1], 0.0), (SQUARE[2], 0.0), (SQUARE[3], 10.0)]
    scene = shown((0, down))
    assert corners(scene) == [list(SQUARE[3]), list(SQUARE[0])]
    assert np.isnan(scene.margin[0])
    assert tuple(scene.colour[0].tolist()) == pytest.approx(NO_MARGIN)
    np.testing.assert_allclose(scene.pressure, [[0.5, 0.5, 0.175]])


@pytest.mark.parametrize("down", [0, 1])
def test_fewer_feet_make_nothing(down: int) -> None:
    scene = shown((0, [(point, 50.0 * (row < down)) for row, point in enumerate(SQUARE)]))
    assert corners(scene) == []
    assert np.isnan(scene.pressure[0, 0]) == (down == 0)
    assert scene.unknown == 0


def test_a_silent_foot_leaves_polygon_and_pressure_unknown() -> None:
    all_down = [(point, 50.0) for point in SQUARE]
    scene = shown((0, all_down), (61, [None, *all_down[1:]]))
    assert corners(scene) == []
    assert np.isnan(scene.pressure).all()
    assert scene.unknown == 1
    # The ground is still where the other feet stand.
    np.testing.assert_allclose(scene.projection, [[0.0, 0.0, 0.3]])


def test_a_foot_that_stands_nowhere_leaves_polygon_and_pressure_unknown() -> None:
    feet = [(NOWHERE, 50.0), *((point, 50.0) for point in SQUARE[1:])]
    scene = shown((0, feet))
    assert (corners(scene), scene.unknown) == ([], 1)
    assert np.isnan(scene.pressure).all()


def test_a_foot_that_never_touched_may_be_dead() -> None:
    feet = [(SQUARE[0], 0.0), *((point, 50.0) for point in SQUARE[1:])]
    assert corners(shown((0, feet), works=False)) == []
    assert len(corners(shown((0, feet), works=True))) == 4


def test_in_flight_the_ground_is_where_the_feet_last_touched_down() -> None:
    down, up = ([(point, load) for point in SQUARE] for load in (50.0, 0.0))
    scene = shown((0, down), (25, down), (50, up))
    np.testing.assert_allclose(scene.projection, [[0.0, 0.0, 0.25]])
    assert corners(scene) == []
    assert scene.touchdowns[0, :4].tolist() == [list(point) for point in SQUARE]
    assert np.isnan(scene.touchdowns[0, 4:]).all()
    assert np.isnan(shown((0, up)).projection).all()


@pytest.mark.parametrize("size", [1e160, 1e308])
def test_places_beyond_all_bounds_do_no_harm(size: float) -> None:
    far = [((x * size, y * size, z * size), 1e153) for x, y, z in SQUARE]
    scene = shown((0, far), (25, far), base=(size, size))
    assert np.isfinite(np.array(corners(scene))).all()
    for points in (scene.pressure, scene.projection):
        assert np.isfinite(points).all() or np.isnan(points).all()
    assert np.isfinite(scene.colour).all()


def test_no_times_no_scene() -> None:
    scene = support_scene(pose(0).pick(np.empty(0, np.int64)), [foot_of([])] * 4)
    assert (len(scene.log_time), len(scene.outline), scene.unknown) == (0, 0, 0)


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
    hull = wrapped({place for place in places if place is not None})
    if len(hull) < 2:
        assert told == []
    elif len(hull) == 2:
        assert sorted(told) == sorted(hull)
    else:
        assert told[0] == told[-1]
        assert told[:-1] == hull
    assert set(outline[np.isfinite(outline[:, 2]), 2]) <= {7.0}


def wrapped(points: set[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the corners of the hull from the leftmost on, counter-clockwise (Andrew 1979)."""

    def half(ordered: list[tuple[float, float]]) -> list[tuple[float, float]]:
        chain: list[tuple[float, float]] = []
        for x, y in ordered:
            while len(chain) > 1 and (
                (chain[-1][0] - chain[-2][0]) * (y - chain[-2][1])
                <= (chain[-1][1] - chain[-2][1]) * (x - chain[-2][0])
            ):
                chain.pop()
            chain.append((x, y))
        return chain[:-1]

    if len(points) < 2:
        return list(points)
    ordered = sorted(points)
    return half(ordered) + half(ordered[::-1])
