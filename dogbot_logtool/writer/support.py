"""Messages of `/support`, stamped out of columns, those of one shape at a time."""

from collections.abc import Iterator

import numpy as np

from dogbot_logtool.core.arrays import Floats, Ints
from dogbot_logtool.core.support_scene import SupportScene
from dogbot_logtool.writer.encoding import (
    Encoding,
    SupportShape,
    SupportStyle,
    support_points,
)
from dogbot_logtool.writer.outgoing import Outgoing, stamped
from dogbot_logtool.writer.template import Template


class SupportStamper:
    """Stamps out the messages of one channel; called from several threads at once."""

    def __init__(self, channel: int, encoding: Encoding, frame: str, style: SupportStyle) -> None:
        self._channel = channel
        self._encoding = encoding
        self._frame = frame
        self._style = style
        self._templates: dict[SupportShape, Template] = {}

    def outgoing(self, scene: SupportScene) -> Iterator[Outgoing]:
        """Yield the messages of a scene."""
        for shape, rows in _shapes(scene):
            template = self._template(shape)
            messages = template.copies(len(rows))
            for stamp in (name[:-4] for name in template.kinds if name.endswith(".sec")):
                template.write_time(messages, stamp, scene.stamp[rows])
            for name, place in _places(scene, shape):
                for axis, column in zip("xyz", place[rows].T, strict=True):
                    messages[f"{name}.{axis}"] = column
            if shape.line_points:
                for part, column in zip("rgba", scene.colour[rows].T, strict=True):
                    messages[part] = column
            yield stamped(self._channel, scene.log_time[rows], messages)

    def _template(self, shape: SupportShape) -> Template:
        # Two threads may learn the same; no harm is done.
        if shape not in self._templates:
            self._templates[shape] = self._encoding.support(shape, self._frame, self._style)
        return self._templates[shape]


def _shapes(scene: SupportScene) -> Iterator[tuple[SupportShape, Ints]]:
    """Yield the shapes that there are, and their rows."""
    line_points = np.isfinite(scene.outline[:, :, 0]).sum(axis=1)
    pressure = np.isfinite(scene.pressure[:, 0])
    projection = np.isfinite(scene.projection[:, 0])
    footfalls = np.isfinite(scene.footfalls[:, :, 0]).sum(axis=1)
    columns = line_points, pressure, projection, footfalls
    sizes = [int(column.max(initial=0)) + 1 for column in columns]
    code = np.ravel_multi_index([column.astype(np.int64) for column in columns], sizes)
    for number in np.unique(code).tolist():
        line, has_pressure, has_projection, marks = np.unravel_index(number, sizes)
        shape = SupportShape(int(line), bool(has_pressure), bool(has_projection), int(marks))
        yield shape, np.flatnonzero(code == number)


def _places(scene: SupportScene, shape: SupportShape) -> Iterator[tuple[str, Floats]]:
    """Yield the names of a shape's points, and (n, 3) m where they are."""
    points = support_points(shape)
    for names, column in (
        (points.line, scene.outline),
        (points.pressure, scene.pressure[:, None]),
        (points.projection, scene.projection[:, None]),
        (points.footfalls, scene.footfalls),
    ):
        yield from zip(names, np.moveaxis(column, 1, 0), strict=False)
