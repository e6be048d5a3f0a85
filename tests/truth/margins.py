"""The static margin of a walk, from where its feet are."""

import math
from collections.abc import Sequence

from tests.truth.recording import Flags, Floats

Point = tuple[float, float]


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
    along, to = (end[0] - start[0], end[1] - start[1]), (point[0] - start[0], point[1] - start[1])
    return along[0] * to[1] - along[1] * to[0]


def margin(corners: Sequence[Point], point: Point) -> float:
    """Return how far a point is inside a convex polygon; negative outside."""
    inside, nearest = True, math.inf
    for start, end in zip(corners, (*corners[1:], corners[0]), strict=True):
        inside &= side(start, end, point) >= 0.0
        edge_x, edge_y = end[0] - start[0], end[1] - start[1]
        to_x, to_y = point[0] - start[0], point[1] - start[1]
        part = (edge_x * to_x + edge_y * to_y) / (edge_x * edge_x + edge_y * edge_y)
        part = min(max(part, 0.0), 1.0)
        nearest = min(nearest, math.hypot(to_x - part * edge_x, to_y - part * edge_y))
    return nearest if inside else -nearest
