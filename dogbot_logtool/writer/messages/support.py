"""Messages of `/support`, made of columns, those of one shape at a time."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Floats, Ints, distinct
from dogbot_logtool.core.scene.foot_style import FOOT_COLOURS, colour_parts, foot_colour
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.writer.encodings.encoding import (
    Encoding,
    SupportLook,
    SupportShape,
    support_points,
)
from dogbot_logtool.writer.message_records import kept_template, write_log_time
from dogbot_logtool.writer.template import TEMPLATES_KEPT, PointArray, Stamps, Template

_COLOURS: Final = np.array([colour_parts(foot_colour(foot)) for foot in range(len(FOOT_COLOURS))])
"""(k, 3) red, green, blue of feet."""


@dataclass(frozen=True, slots=True)
class _ShapeTemplate:
    """How messages of one shape are made."""

    template: Template
    stamps: tuple[str, ...]
    """Names of the stamps."""
    points: tuple[PointArray | None, ...]
    """Outline, pressure, projection and touchdowns; None for what the shape does not have."""


class SupportWriter:
    """Makes the messages of one channel; called in several threads or processes at once."""

    def __init__(self, channel: int, encoding: Encoding, frame: str, style: SupportLook) -> None:
        self._channel = channel
        self._encoding = encoding
        self._frame = frame
        self._style = style

    def records(self, scene: SupportScene, stamps: Stamps) -> Iterator[NDArray[np.void]]:
        """Yield the message records of a scene, those of one size at a time.

        Args:
            scene: (n,) times.
            stamps: the same times in the encoding's form.
        """
        columns = (
            scene.outline,
            scene.pressure[:, None],
            scene.projection[:, None],
            scene.touchdowns,
        )
        for shape, rows in _shapes(columns):
            of_shape = _template(self._encoding, shape, self._frame, self._style, self._channel)
            template = of_shape.template
            records = template.copies(len(rows))
            picked = stamps.pick(rows)
            for name in of_shape.stamps:
                template.write_stamps(records, name, picked)
            for points, column in zip(of_shape.points, columns, strict=True):
                if points is not None:
                    points.view(records)[:] = column[rows, : points.shape[0]]
            self._colour_touchdowns(records, scene.touchdown_feet[rows], shape)
            if shape.line_points:
                for part, parts in zip("rgba", scene.colour[rows].T, strict=True):
                    records[part] = parts
            write_log_time(records, scene.log_time[rows])
            yield records

    def _colour_touchdowns(
        self, records: NDArray[np.void], feet: Ints, shape: SupportShape
    ) -> None:
        """Give touchdowns the colours of their feet.

        Args:
            records: (n,) messages of one shape.
            feet: (n, k) indices; the first of each row are those of the shape's touchdowns.
            shape: of the messages.
        """
        for column, name in enumerate(support_points(shape).touchdowns):
            of_foot = _COLOURS[feet[:, column] % len(_COLOURS)]
            for part, values in zip("rgb", of_foot.T, strict=True):
                records[f"{name}.{part}"] = values


@lru_cache(TEMPLATES_KEPT)
def _template(
    encoding: Encoding, shape: SupportShape, frame: str, style: SupportLook, channel: int
) -> _ShapeTemplate:
    """Return how messages of a shape are made; outputs that are alike share it."""
    template = kept_template(encoding.support, channel, shape, frame, style)
    points = support_points(shape)
    kinds = points.line, points.pressure, points.projection, points.touchdowns
    return _ShapeTemplate(
        template,
        tuple(name[: -len(".sec")] for name in template.kinds if name.endswith(".sec")),
        tuple(template.point_array(names) if names else None for names in kinds),
    )


def _shapes(columns: Sequence[Floats]) -> Iterator[tuple[SupportShape, Ints]]:
    """Yield the shapes that occur, and their rows.

    Args:
        columns: (n, k, 3) outline, pressure, projection and touchdowns; NaN where there are none.
    """
    counts = [np.isfinite(column[:, :, 0]).sum(axis=1) for column in columns]
    sizes = [column.shape[1] + 1 for column in columns]
    code = np.ravel_multi_index(counts, sizes)
    for number in distinct(code).tolist():
        line, pressure, projection, touchdowns = map(int, np.unravel_index(number, sizes))
        shape = SupportShape(line, bool(pressure), bool(projection), touchdowns)
        yield shape, np.flatnonzero(code == number)
