"""Records of annotations, made of columns."""

from collections.abc import Callable, Iterator, Sequence
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.core.arrays import Flags, Floats, Ints, distinct, rows_by_group
from dogbot_logtool.core.scene.arrows import Arrows
from dogbot_logtool.core.scene.foot_style import FOOT_COLOURS, colour_parts, foot_colour
from dogbot_logtool.core.scene.labels import Labels
from dogbot_logtool.core.scene.legs import LegLines
from dogbot_logtool.core.scene.loads import Loads
from dogbot_logtool.core.scene.support_scene import SupportScene
from dogbot_logtool.writer.drawing import SHAFT_SHARE, SupportShape, leg_points, support_points
from dogbot_logtool.writer.encodings.encoding import LOAD_STATES
from dogbot_logtool.writer.message_records import timed_records, write_log_time, write_pose
from dogbot_logtool.writer.template import Stamps, Template

Records = NDArray[np.void]
"""Copies of a template of records."""
_COLOURS: Final = np.array([colour_parts(foot_colour(foot)) for foot in range(len(FOOT_COLOURS))])
"""(k, 3) red, green, blue of feet."""
_LABEL_WIDTH: Final = 6
"""Characters of the number and its unit in a label, padded with spaces."""
_LARGEST_N: Final = 9999.0
_BEYOND: Final = ">10 kN"


class Shown(Protocol):
    """Columns of what is shown or removed."""

    @property
    def foot(self) -> Ints:
        """(n,) index of the foot."""

    @property
    def log_time(self) -> Ints:
        """(n,) ns."""

    @property
    def shown(self) -> Flags:
        """(n,) False: it is removed."""


def transform_records(
    template: Template, log_time: Ints, stamp: Ints, translation: Floats, rotation: Floats
) -> Records:
    """Return messages of k transforms each.

    Args:
        template: of a message.
        log_time: (n,) ns.
        stamp: (n,) ns.
        translation: (n, k, 3) m.
        rotation: (n, k, 4) quaternions, x y z w.
    """
    records = template.copies(len(log_time))
    write_log_time(records, log_time)
    stamps = template.stamps("0.stamp", stamp)
    for index in range(translation.shape[1]):
        template.write_stamps(records, f"{index}.stamp", stamps)
        write_pose(records, translation[:, index], rotation[:, index], f"{index}.")
    return records


def shown_records(
    templates: Sequence[tuple[Template, Template]],
    columns: Shown,
    stamps: Stamps,
    fill: Callable[[Records, Ints], None],
) -> Iterator[Records]:
    """Yield messages that show or remove something, foot by foot.

    Args:
        templates: of each foot, shown and removed.
        columns: (n,) of any feet.
        stamps: their stamps in the encoding's form.
        fill: writes some rows into copies of a template; a removal has nothing but times.
    """
    for group, rows in rows_by_group(2 * columns.foot + ~columns.shown):
        records = timed_records(templates[group // 2][group % 2], columns.log_time, stamps, rows)
        if group % 2 == 0:
            fill(records, rows)
        yield records


def fill_arrows(arrows: Arrows, records: Records, rows: Ints) -> None:
    """Write some arrows into copies of their template."""
    write_pose(records, arrows.position.take(rows, 0), arrows.orientation.take(rows, 0))
    length = arrows.length[rows]
    if "length" in (records.dtype.names or ()):
        records["length"] = length
    else:
        records["shaft"] = SHAFT_SHARE * length
        records["head"] = (1.0 - SHAFT_SHARE) * length
    for part, column in zip("rgba", arrows.colour.take(rows, 0).T, strict=True):
        records[part] = column


def fill_labels(labels: Labels, records: Records, rows: Ints) -> None:
    """Write some labels into copies of their template."""
    for axis, column in zip("xyz", labels.position.take(rows, 0).T, strict=True):
        records[axis] = column
    records["text"] = [
        (_BEYOND if force > _LARGEST_N else f"{force:.0f} N").center(_LABEL_WIDTH).encode()
        for force in labels.force[rows].tolist()
    ]


def load_records(templates: Sequence[Template], loads: Loads, stamps: Stamps) -> Iterator[Records]:
    """Yield messages of loads, those of one foot and state at a time.

    Args:
        templates: of each foot and of each of its `LOAD_STATES`.
        loads: (n,) of any feet.
        stamps: their stamps in the encoding's form.
    """
    for group, rows in rows_by_group(len(LOAD_STATES) * loads.foot + loads.state):
        records = timed_records(templates[group], loads.log_time, stamps, rows)
        records["in_contact"] = loads.in_contact[rows]
        records["force"] = loads.force[rows]
        records["force_bw"] = loads.body_weights[rows]
        yield records


def leg_records(
    template_of: Callable[[tuple[int, ...]], Template], legs: LegLines, stamps: Stamps
) -> Iterator[Records]:
    """Yield messages of legs, those of the same standing feet at a time.

    Args:
        template_of: returns the template of a message of some feet.
        legs: (n,) times.
        stamps: the same times in the encoding's form.
    """
    standing = np.isfinite(legs.ends[:, :, 0, 0])
    patterns, pattern = np.unique(standing, axis=0, return_inverse=True)
    for number, flags in enumerate(patterns):
        feet = tuple(np.flatnonzero(flags).tolist())
        rows = np.flatnonzero(pattern.reshape(-1) == number)
        template = template_of(feet)
        records = timed_records(template, legs.log_time, stamps, rows)
        if feet:
            ends = legs.ends[rows][:, feet].reshape(len(rows), -1, 3)
            template.point_array(leg_points(len(feet))).view(records)[:] = ends
        yield records


def support_records(
    template_of: Callable[[SupportShape], Template], scene: SupportScene, stamps: Stamps
) -> Iterator[Records]:
    """Yield messages of what the robot stands on, those of one shape at a time.

    Args:
        template_of: returns the template of a message of a shape.
        scene: (n,) times.
        stamps: the same times in the encoding's form.
    """
    columns = scene.outline, scene.pressure[:, None], scene.projection[:, None], scene.touchdowns
    for shape, rows in _shapes(columns):
        template = template_of(shape)
        records = template.copies(len(rows))
        write_log_time(records, scene.log_time[rows])
        for name in template.kinds:
            if name.endswith(".sec"):
                template.write_stamps(records, name.removesuffix(".sec"), stamps.pick(rows))
        names = support_points(shape)
        for points, column in zip(names, columns, strict=True):
            if points:
                template.point_array(points).view(records)[:] = column[rows, : len(points)]
        _write_colours(records, names[3], scene.touchdown_feet[rows])
        if shape.line_points:
            for part, parts in zip("rgba", scene.colour[rows].T, strict=True):
                records[part] = parts
        yield records


def _write_colours(records: Records, touchdowns: Sequence[str], feet: Ints) -> None:
    """Give touchdowns the colours of their feet.

    Args:
        records: (n,) messages of one shape.
        touchdowns: names of k touchdowns.
        feet: (n, at least k) indices of their feet.
    """
    for column, name in enumerate(touchdowns):
        of_foot = _COLOURS[feet[:, column] % len(_COLOURS)]
        for part, values in zip("rgb", of_foot.T, strict=True):
            records[f"{name}.{part}"] = values


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
