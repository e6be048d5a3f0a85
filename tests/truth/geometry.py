"""Turns as quaternions x, y, z, w, and what polygons hold."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]
Point = tuple[float, float]


def about_axis(axis: int, angle: Floats) -> Floats:
    """(n, 4) quaternions x, y, z, w of turns about a coordinate axis."""
    turn = np.zeros((len(angle), 4))
    turn[:, axis], turn[:, 3] = np.sin(angle / 2.0), np.cos(angle / 2.0)
    return turn


def turned(rotation: Floats, vector: Floats) -> Floats:
    """(n, 3) vectors turned by (n, 4) unit quaternions."""
    along, real = rotation[:, :3], rotation[:, 3:]
    twice = 2.0 * np.cross(along, vector)
    return np.asarray(vector + real * twice + np.cross(along, twice))


def product(first: Floats, second: Floats) -> Floats:
    """(n, 4) quaternions: `second` in the frame of `first`."""
    a, b = first[:, :3], second[:, :3]
    imaginary = first[:, 3:] * b + second[:, 3:] * a + np.cross(a, b)
    real = first[:, 3] * second[:, 3] - (a * b).sum(axis=1)
    return np.concatenate([imaginary, real[:, None]], axis=1)


def inverse(rotation: Floats) -> Floats:
    """(n, 4) unit quaternions turned back."""
    return rotation * [-1.0, -1.0, -1.0, 1.0]


def margins(feet: Floats, down: Flags, body: Floats) -> list[float]:
    """Return the margins at the times with three feet down.

    Args:
        feet: (n, feet, 2) m.
        down: (n, feet).
        body: (n, 2) m.
    """
    return [
        margin(hull([tuple(point) for point in standing[is_down].tolist()]), tuple(at.tolist()))
        for standing, is_down, at in zip(feet, down, body, strict=True)
        if is_down.sum() >= 3
    ]


def hull(points: Sequence[Point]) -> list[Point]:
    """Return the convex hull, counter-clockwise: Andrew's monotone chain."""
    ordered = sorted(points)

    def chain(way: Sequence[Point]) -> list[Point]:
        found: list[Point] = []
        for point in way:
            while len(found) > 1 and side(found[-2], found[-1], point) <= 0.0:
                found.pop()
            found.append(point)
        return found[:-1]

    return chain(ordered) + chain(ordered[::-1])


def side(start: Point, end: Point, point: Point) -> float:
    """Return twice the area of a triangle: positive for a point to the left of the way."""
    return (end[0] - start[0]) * (point[1] - start[1]) - (end[1] - start[1]) * (point[0] - start[0])


def margin(corners: Sequence[Point], point: Point) -> float:
    """Return how far a point is inside a convex polygon; negative outside."""
    inside, nearest, here = True, math.inf, complex(*point)
    for start, end in zip(corners, (*corners[1:], corners[0]), strict=True):
        inside &= side(start, end, point) >= 0.0
        edge, to = complex(*end) - complex(*start), here - complex(*start)
        part = min(max((to / edge).real, 0.0), 1.0)
        nearest = min(nearest, abs(to - part * edge))
    return nearest if inside else -nearest
