"""Messages of `/support`, stamped out of columns, those of one shape at a time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.geometry.arrays import Floats, Ints
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.writer.encodings.encoding import (
    Encoding,
    SupportShape,
    SupportStyle,
    support_points,
)
from dogbot_logtool.writer.outgoing import record_template, write_log_time
from dogbot_logtool.writer.template import Stamps, Stretch, Template


@dataclass(frozen=True, slots=True)
class _Form:
    """What messages of one shape are made with."""

    template: Template
    stamps: tuple[str, ...]
    """Names of the times."""
    stretches: tuple[Stretch | None, ...]
    """Where outline, pressure, projection and footfalls stand, as far as there are such."""


class SupportStamper:
    """Stamps out the messages of one channel; called in several threads or processes at once."""

    def __init__(self, channel: int, encoding: Encoding, frame: str, style: SupportStyle) -> None:
        self._channel = channel
        self._encoding = encoding
        self._frame = frame
        self._style = style
        self._forms: dict[SupportShape, _Form] = {}

    def outgoing(self, scene: SupportScene, stamps: Stamps) -> Iterator[NDArray[np.void]]:
        """Yield the records of a scene, those of one size at a time.

        Args:
            scene: (n,) times.
            stamps: the same times as messages of the encoding write them.
        """
        columns = (
            scene.outline,
            scene.pressure[:, None],
            scene.projection[:, None],
            scene.footfalls,
        )
        for shape, rows in _shapes(columns):
            form = self._form(shape)
            template = form.template
            records = template.copies(len(rows))
            picked = stamps.pick(rows)
            for name in form.stamps:
                template.write_stamps(records, name, picked)
            for stretch, column in zip(form.stretches, columns, strict=True):
                if stretch is not None:
                    stretch.of(records)[:] = column[rows, : stretch.shape[0]]
            if shape.line_points:
                for part, parts in zip("rgba", scene.colour[rows].T, strict=True):
                    records[part] = parts
            write_log_time(records, scene.log_time[rows])
            yield records

    def _form(self, shape: SupportShape) -> _Form:
        # Two threads may learn the same; no harm is done.
        if shape not in self._forms:
            message = self._encoding.support(shape, self._frame, self._style)
            template = record_template(message, self._channel)
            points = support_points(shape)
            kinds = points.line, points.pressure, points.projection, points.footfalls
            self._forms[shape] = _Form(
                template,
                tuple(name[: -len(".sec")] for name in template.kinds if name.endswith(".sec")),
                tuple(template.stretch(names) if names else None for names in kinds),
            )
        return self._forms[shape]


def _shapes(columns: Sequence[Floats]) -> Iterator[tuple[SupportShape, Ints]]:
    """Yield the shapes that there are, and their rows.

    Args:
        columns: (n, k, 3) outline, pressure, projection and footfalls; NaN where there are none.
    """
    counts = [np.isfinite(column[:, :, 0]).sum(axis=1) for column in columns]
    sizes = [column.shape[1] + 1 for column in columns]
    code = np.ravel_multi_index(counts, sizes)
    for number in np.unique(code).tolist():
        line, pressure, projection, footfalls = map(int, np.unravel_index(number, sizes))
        shape = SupportShape(line, bool(pressure), bool(projection), footfalls)
        yield shape, np.flatnonzero(code == number)
