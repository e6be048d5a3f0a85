"""Conversions of logs, made once for each set of options, and compared with what is expected."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, get_args

import numpy as np
from mcap import records
from mcap.stream_reader import StreamReader

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.results import Conversion
from dogbot_logtool.writer.chunks import Compression
from tests.oracles.annotated_file import Written, read_written
from tests.oracles.conversion import Arrow, Load, Pose
from tests.oracles.recorded import read_log
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


def assert_same_loads(actual: list[Load], expected: list[Load], opening: int) -> None:
    """Besides the expected rows there are only the first time's, and those of silences."""
    times = {one.log_time for one in expected}
    extra = [one for one in actual if one.log_time not in times]
    assert all(one.log_time == opening or math.isnan(one.force) for one in extra)
    actual = [one for one in actual if one.log_time in times]
    assert [(one.log_time, one.stamp, one.in_contact) for one in actual] == [
        (one.log_time, one.stamp, one.in_contact) for one in expected
    ]
    for name in ("force", "body_weights"):
        told = [getattr(one, name) for one in actual]
        wanted = [getattr(one, name) for one in expected]
        # Forces are kept with 24 bits, and may be turned into the world.
        np.testing.assert_allclose(told, wanted, rtol=3e-7, atol=1e-14)


@dataclass(frozen=True)
class Done:
    conversion: Conversion
    path: Path

    @cached_property
    def written(self) -> Written:
        return read_written(self.path)


_DONE: dict[tuple[Path, str], Done] = {}


def converted(folder: Path, log: Path, **options: Any) -> Done:
    """Convert a log, once for the same options."""
    key = (log, repr(sorted(options.items())))
    if key not in _DONE:
        target = folder / f"{len(_DONE)}.mcap"
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
