"""Static margins, and the rise that tips a robot over, step by step."""

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.stability import energy_margin_in, hulls, margin_in

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
