"""Conversion against an oracle that takes one message at a time.

The logs are read with the containers' own libraries and decoded by rosbags with the definitions
that are recorded in them. What should be written is computed in plain Python, a message at a time,
by the formulas of docs/convert.md; what was written is read and decoded by the mcap library and its
decoders, checksums and all. Nothing of the product takes part in either.
"""

import itertools
import json
import re
from collections import Counter
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.scene.styles import ARROW_STYLES
from dogbot_logtool.errors import CallError
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from tests.commands.conversions import (
    COMPRESSIONS,
    IN_WORLD,
    MATRIX,
    assert_same_arrows,
    assert_same_loads,
    assert_same_poses,
    codes,
    converted,
    opening_of,
)
from tests.measured import measured_contact
from tests.oracles.annotated_file import (
    described_robots,
    read_written,
    written_arrows,
    written_loads,
    written_poses,
)
from tests.oracles.conversion import LOGS, TICK_NS, expected_arrows, expected_loads, expected_poses
from tests.oracles.recorded import (
    FEET,
    S,
    arrow_topic,
    read_log,
)
from tests.oracles.ros1_logs import (
    odd_contacts,
    small_walk,
    write_bag,
    write_ros1_mcap,
)
from tests.paths import TROT, TROUBLED, WALK

STYLES = tuple(ARROW_STYLES)


@pytest.mark.parametrize(
    ("log", "style", "encoding"), MATRIX, ids=[f"{p.stem}-{s}-{e}" for p, s, e in MATRIX]
)
def test_annotations_are_what_message_by_message_conversion_gives(
    folder: Path, log: Path, style: str, encoding: str
) -> None:
    done = converted(folder, log, style=style, encoding=encoding)
    assert done.conversion.damage.exit_code == 0
    for foot in FEET:
        contact = measured_contact(log, foot)
        arrows = expected_arrows(log, foot, style, in_world=IN_WORLD[log], contact=contact)
        assert_same_arrows(
            written_arrows(done.written, foot, encoding, style),
            arrows,
            exactly=style == "classic",
        )
        loads = written_loads(done.written, foot, encoding)
        assert_same_loads(loads, expected_loads(log, foot, contact), opening_of(log))
        assert done.conversion.annotations[arrow_topic(foot)] == len(arrows)
    # The logs have a /tf of their own; only transforms of its own ROS fit on it.
    joined = encoding == ("ros2" if log == WALK else "ros1")
    topic = "/tf" if joined else "/dogbot_logtool/tf"
    poses = written_poses(done.written, topic, encoding)
    assert_same_poses(poses, expected_poses(log, at_ticks=True), opening_of(log))
    assert ("TOPIC_MOVED" in codes(done.conversion)) != joined


def test_lengths_of_classic_markers_are_exact(folder: Path) -> None:
    done = converted(folder, TROT, style="classic", encoding="ros1")
    for foot in FEET:
        told = [a.length for a in written_arrows(done.written, foot, "ros1", "classic")]
        wanted = [a.length for a in expected_arrows(TROT, foot, "classic", in_world=False)]
        np.testing.assert_array_equal(told, wanted)


@pytest.mark.parametrize(
    ("log", "encoding"),
    [(TROUBLED, "ros2"), (TROT, "ros1"), (WALK, "foxglove")],
    ids=lambda each: each.stem if isinstance(each, Path) else each,
)
def test_tf_rate_0_writes_every_pose(folder: Path, log: Path, encoding: str) -> None:
    done = converted(folder, log, tf_rate=0.0, encoding=encoding, copy=False)
    poses = written_poses(done.written, "/tf", encoding)
    assert_same_poses(poses, expected_poses(log, at_ticks=False), opening_of(log))


def test_tf_has_fifty_poses_a_second(folder: Path) -> None:
    poses = written_poses(converted(folder, TROT, copy=False).written, "/tf", "foxglove")
    assert len(poses) == 401
    assert {after.stamp - before.stamp for before, after in pairwise(poses)} == {TICK_NS}


def test_counts_of_what_cannot_be_drawn_are_told(folder: Path) -> None:
    damage = json.loads(TROUBLED.with_suffix(".truth.json").read_text(encoding="utf-8"))["damage"]
    not_finite = sum(
        len(numbers)
        for kind in ("nan_force", "infinite_position")
        for numbers in damage[kind].values()
    )
    counts = converted(folder, TROUBLED).conversion.counts
    assert counts["not_finite"] == not_finite
    assert converted(folder, TROUBLED).conversion.bad_poses == len(damage["zero_quaternion"])
    assert codes(converted(folder, TROUBLED).conversion) >= {"NOT_FINITE"}


def test_zero_stamps_are_replaced_by_log_times_and_said(folder: Path) -> None:
    done = converted(folder, TROUBLED)
    assert "BAD_STAMPS" in codes(done.conversion)
    loads = written_loads(done.written, "back_left", "foxglove")
    assert all(load.stamp == load.log_time for load in loads)


def test_start_and_end_choose_messages_by_log_time(folder: Path) -> None:
    first = min(one.log_time for one in read_log(WALK))
    done = converted(folder, WALK, start=2.0005, end=4.25)
    start, end = first + 2_000_500_000, first + 4_250_000_000
    wanted = Counter(
        (one.topic, one.log_time, one.data)
        for one in read_log(WALK)
        if start <= one.log_time <= end
    )
    copied = Counter(
        (channel.topic, m.log_time, m.data)
        for m in done.written.messages
        if (channel := done.written.recorded().get(m.channel_id)) is not None
    )
    assert copied == wanted
    assert described_robots(done.written) == [(start, "dogbot")]
    for foot in FEET:
        loads = [one for one in expected_loads(WALK, foot) if start <= one.log_time <= end]
        assert_same_loads(written_loads(done.written, foot, "foxglove"), loads, start)
    poses = [p for p in expected_poses(WALK, at_ticks=False) if start <= p.log_time <= end]
    told = written_poses(done.written, "/dogbot_logtool/tf", "foxglove")
    if poses[0].log_time > start:
        assert told.pop(0) == replace(poses[0], log_time=start, stamp=start)
    assert told[0] == poses[0]
    assert (
        told[1:]
        == [
            pose for pose in expected_poses(WALK, at_ticks=True) if pose.log_time > told[0].log_time
        ][: len(told) - 1]
    )
    assert poses[-1].stamp - told[-1].stamp < TICK_NS


def test_a_time_range_between_two_messages_is_refused(folder: Path) -> None:
    """The range lies inside a chunk, so the chunk is read, but nothing in it is taken."""
    for log in (TROUBLED, WALK):
        times = sorted({one.log_time for one in read_log(log)})
        place = next(n for n in range(100, len(times)) if times[n + 1] - times[n] > 10_000)
        start, end = times[place] - times[0] + 2_000, times[place + 1] - times[0] - 2_000
        with pytest.raises(CallError, match="no message was recorded from"):
            converted(folder, log, start=start / S, end=end / S)


@pytest.mark.parametrize("style", STYLES)
def test_forces_of_all_kinds(tmp_path: Path, style: str) -> None:
    log = write_bag(tmp_path / "odd.bag", odd_contacts())
    options = ConvertOptions(
        robot="dogbot", style=style, encoding="ros1", set={"wrench_frame": "world"}
    )
    conversion = convert(log, tmp_path / "out.mcap", options)
    written = read_written(tmp_path / "out.mcap")
    contact = measured_contact(log, "front_left", MeasureOptions(robot="dogbot"))
    expected = expected_arrows(log, "front_left", style, in_world=True, contact=contact)
    told = written_arrows(written, "front_left", "ros1", style)
    assert_same_arrows(told, expected, exactly=style == "classic")
    if style == "classic":
        np.testing.assert_array_equal([a.length for a in told], [a.length for a in expected])
        counts = conversion.counts
        assert (counts["overflow"], counts["no_position"], counts["not_finite"]) == (1, 1, 0)
        assert "NOT_FINITE" in codes(conversion)
    else:
        # The touch without a point is too light, and too short, to be a stance.
        assert conversion.counts["no_position"] == 0
        assert conversion.counts["not_finite"] == 8


# --- Sameness -------------------------------------------------------------------------------------


@pytest.mark.parametrize("log", LOGS, ids=lambda log: log.stem)
def test_sample_logs_convert_to_the_same_bytes_whatever_the_jobs(
    folder: Path, tmp_path: Path, log: Path
) -> None:
    options: dict[str, Any] = {"style": "force"} if log == WALK else {}
    target = tmp_path / "out.mcap"
    convert(log, target, ConvertOptions(jobs=3, encoding="foxglove", **options))
    assert (
        target.read_bytes()
        == converted(folder, log, encoding="foxglove", **options).path.read_bytes()
    )


def test_provenance_tells_how_but_not_when_or_where(folder: Path) -> None:
    done = converted(folder, TROUBLED, style="force", encoding="ros1")
    (provenance,) = done.written.metadata
    assert provenance.name == "dogbot_logtool"
    told = provenance.metadata
    assert told["input"] == "dogbot_troubled.bag"
    assert (told["style"], told["encoding"], told["robot"]) == ("force", "ros1", "dogbot")
    assert (told["mass_kg"], told["copy"], told["lost_messages"]) == ("21.261", "True", "0")
    assert not [value for value in told.values() if "/" in value and value.startswith("/")]
    everything = json.dumps(told)
    assert str(TROUBLED.parent) not in everything
    assert str(folder) not in everything
    assert not re.search(r"20\d\d-\d\d|\d\d:\d\d", everything)


def test_the_place_of_the_log_leaves_no_trace(folder: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "else where"
    elsewhere.mkdir()
    copy = elsewhere / TROUBLED.name
    copy.write_bytes(TROUBLED.read_bytes())
    convert(copy, tmp_path / "out.mcap", ConvertOptions())
    assert (tmp_path / "out.mcap").read_bytes() == converted(folder, TROUBLED).path.read_bytes()


# --- Progress, and an outside checker -------------------------------------------------------------


def test_progress_ends_at_the_whole(tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    convert(
        TROUBLED,
        tmp_path / "out.mcap",
        ConvertOptions(copy=False),
        lambda done, total: told.append((done, total)),
    )
    assert told[-1][0] == told[-1][1]
    assert told == sorted(told)


@pytest.mark.parametrize("kind", ["bag", "mcap"])
def test_the_doctor_finds_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str
) -> None:
    """`pymcap-cli doctor` over all encodings and all compressions, each with both copy modes."""
    from pymcap_cli.cli import app as pymcap_cli  # noqa: PLC0415 - takes long to load

    if kind == "bag":
        log = write_bag(tmp_path / "log.bag", small_walk(0.3))
    else:
        log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.3), extras=True)
    target = tmp_path / "out.mcap"
    encodings = itertools.cycle(ENCODINGS)
    for compression in (*COMPRESSIONS, None):
        for copy in (True, False):
            options = ConvertOptions(
                encoding=next(encodings), compression=compression, copy=copy, overwrite=True
            )
            convert(log, target, options)
            code = pymcap_cli(["doctor", str(target)], result_action="return_value")
            told = capsys.readouterr()
            assert code == 0, told.out + told.err
            assert "passed MCAP doctor checks" in " ".join(told.out.split())
            assert "warning" not in told.out


def test_nothing_but_the_output_is_left(tmp_path: Path) -> None:
    convert(TROUBLED, tmp_path / "out.mcap", ConvertOptions(jobs=2))
    assert [file.name for file in tmp_path.iterdir()] == ["out.mcap"]
