"""Arrows along the axes, outlines of support polygons, and the rise that tips a robot over."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.scene.arrows import turn_x_to
from dogbot_logtool.core.scene.support_scene import outlines
from dogbot_logtool.core.stability import energy_margin_in, hulls, margin_in
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


FEET = np.array([[0.3, 0.15, 0.0], [0.3, -0.15, 0.0], [-0.3, 0.15, 0.0], [-0.3, -0.15, 0.0]])
BODY = np.array([0.05, 0.02, 0.4])


def turned(points: Floats, axis: Floats, angle: float | Floats) -> Floats:
    """Turn points about an axis through the origin (Rodrigues), by one angle or (n, 1) of them."""
    along = np.outer(points @ axis, axis) * (1.0 - np.cos(angle))
    return np.asarray(points * np.cos(angle) + np.cross(axis, points) * np.sin(angle) + along)


def energy_margin(points: Floats, body: Floats) -> Floats:
    hull = hulls(points[:, :, :2])
    return energy_margin_in(hull, points, body, margin_in(hull, body[:, :2]))


def least_rise(corners: Floats, body: Floats) -> float:
    """Tip the body over each edge in small steps; return the least of the highest rises."""
    rises = []
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        axis = (end - start) / np.linalg.norm(end - start)
        steps = np.linspace(-1.6, 1.6, 3201)[:, None]
        height = turned((body - start)[None], axis, steps)[:, 2]
        rises.append(float(height.max() - (body - start)[2]))
    return min(rises)


@pytest.mark.parametrize("slope_rad", [0.0, 0.2, 0.4])
@pytest.mark.parametrize("lean", [(0.0, 1.0, 0.0), (0.6, 0.8, 0.0)])
@pytest.mark.parametrize("feet", [(0, 1, 2, 3), (0, 1, 2)])
def test_the_least_rise_over_an_edge(
    slope_rad: float, lean: tuple[float, ...], feet: tuple[int, ...]
) -> None:
    standing = turned(FEET, np.array(lean), slope_rad)
    body = turned(BODY[None], np.array(lean), slope_rad)[0]
    points = np.full((1, 4, 3), np.nan)
    points[0, list(feet)] = standing[list(feet)]
    found = float(energy_margin(points, body[None])[0])
    around = {(0, 1, 2, 3): [0, 1, 3, 2], (0, 1, 2): [0, 1, 2]}[feet]
    corner = standing[around]
    edge, away = np.roll(corner, -1, axis=0) - corner, body - corner
    sides = edge[:, 0] * away[:, 1] - edge[:, 1] * away[:, 0]
    if (sides <= 0.0).all() or (sides >= 0.0).all():
        assert found == pytest.approx(least_rise(corner, body), abs=1e-6)
    else:
        assert np.isnan(found)


def test_nothing_outside_and_without_an_area() -> None:
    outside = np.array([[0.5, 0.0, 0.4]])
    assert np.isnan(energy_margin(FEET[None], outside)).all()
    assert np.isnan(energy_margin(FEET[None, :2], BODY[None])).all()


def test_beside_a_corner_the_margin_is_the_way_to_it() -> None:
    square = np.array([[[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]]])
    assert margin_in(hulls(square), np.array([[2.0, 2.0]]))[0] == pytest.approx(-np.sqrt(2.0))
