"""Conversions of logs, made once for each set of options, and compared with what is expected."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, get_args

import numpy as np
from mcap import records
from mcap.stream_reader import StreamReader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.results import Conversion
from dogbot_logtool.writer.chunks import Compression
from tests.measured import measured, measured_contact
from tests.oracles.annotated_file import Written, read_written
from tests.oracles.conversion import Arrow, Load, Pose
from tests.oracles.recorded import BODY_WEIGHT_N, read_log
from tests.paths import TROT, TROUBLED, WALK

IN_WORLD = {TROT: False, WALK: True, TROUBLED: False}
"""Whether wrenches are in the world frame, as the logs' truths say."""
COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)


MATRIX = [
    (TROUBLED, "classic", "foxglove"),
    (TROUBLED, "pressure", "ros2"),
    (TROUBLED, "force", "ros1"),
    (WALK, "force", "foxglove"),
]


def assert_same_arrows(
    actual: list[Arrow], expected: list[Arrow], style: str, encoding: str
) -> None:
    exactly = style == "classic"
    rows = [(arrow.log_time, arrow.stamp, not arrow.position) for arrow in actual]
    assert rows == [(arrow.log_time, arrow.stamp, not arrow.position) for arrow in expected]
    for name in ("position", "orientation", "length"):
        told = [getattr(arrow, name) for arrow in actual if arrow.position]
        wanted = [getattr(arrow, name) for arrow in expected if arrow.position]
        if exactly and (name != "length" or encoding != "foxglove"):
            np.testing.assert_array_equal(told, wanted)
        else:
            # Forces are kept with 24 bits, positions with all; a length is written as shaft and
            # head in Foxglove's messages, which round; in `classic` nothing else does.
            rtol = 1e-13 if exactly or name == "position" else 3e-7
            np.testing.assert_allclose(told, wanted, rtol=rtol, atol=1e-12 if exactly else 3e-7)
    colours = np.array([arrow.colour for arrow in actual if arrow.position])
    wanted_colours = np.array([arrow.colour for arrow in expected if arrow.position], np.float32)
    if exactly:
        np.testing.assert_array_equal(colours.astype(np.float32), wanted_colours)
    else:
        np.testing.assert_allclose(colours, wanted_colours, rtol=1e-5, atol=1e-5)


def assert_measured_loads(
    actual: list[Load], log: Path, foot: str, span: tuple[int, int] | None = None
) -> None:
    """Besides those that were measured there are only the first time's, and those of silences."""
    first, last = span or (opening_of(log), 1 << 63)
    (track,) = (each.record.track for each in measured(log).walk.feet if each.name == foot)
    contact = measured_contact(log, foot) or {}
    force = dict(zip(track.log_time.tolist(), track.force.tolist(), strict=True))
    force = {time: force[time] for time in sorted(force) if first <= time <= last}
    extra = [one for one in actual if one.log_time not in force]
    assert all(one.log_time == first or math.isnan(one.force) for one in extra)
    actual = [one for one in actual if one.log_time in force]
    told = [(one.log_time, one.in_contact) for one in actual]
    assert told == [(time, contact.get(time, False)) for time in force]
    newtons = np.array([*force.values()])
    np.testing.assert_allclose([one.force for one in actual], newtons, rtol=1e-12)
    weights = [one.body_weights for one in actual]
    np.testing.assert_allclose(weights, newtons / BODY_WEIGHT_N, rtol=1e-12)


@dataclass(frozen=True)
class Done:
    conversion: Conversion
    path: Path

    @cached_property
    def written(self) -> Written:
        return read_written(self.path)


_DONE: dict[tuple[Path, str], Done] = {}
_FOLDER = TemporaryDirectory(prefix="converted")


def converted(log: Path, **options: Any) -> Done:
    """Convert a log, once for the same options."""
    key = (log, repr(sorted(options.items())))
    if key not in _DONE:
        target = Path(_FOLDER.name) / f"{len(_DONE)}.mcap"
        conversion = convert(log, target, ConvertOptions(**options))
        _DONE[key] = Done(conversion, target)
    return _DONE[key]


def opening_of(log: Path) -> int:
    """The first log time, ns."""
    return min(message.log_time for message in read_log(log))


def assert_same_poses(actual: list[Pose], expected: list[Pose], opening: int) -> None:
    """The first pose also stands at the log's first time, unless it is there already."""
    if expected[0].log_time > opening:
        first = actual.pop(0)
        assert first == replace(expected[0], log_time=opening, stamp=opening)
    assert actual == expected


def codes(conversion: Conversion) -> set[str]:
    return {finding.code for finding in conversion.findings}


def chunks_of(path: Path) -> list[records.Chunk]:
    with path.open("rb") as stream:
        return [
            record
            for record in StreamReader(stream, emit_chunks=True).records
            if isinstance(record, records.Chunk)
        ]
