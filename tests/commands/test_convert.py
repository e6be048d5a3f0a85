"""Conversion against an oracle that takes one message at a time.

The logs are read with the containers' own libraries and decoded by rosbags with the definitions
that are recorded in them. What should be written is computed in plain Python, a message at a time,
by the formulas of docs/convert.md; what was written is read and decoded by the mcap library and its
decoders, checksums and all. Nothing of the product takes part in either.
"""

import itertools
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, get_args

import numpy as np
import pytest
from mcap import records
from mcap.stream_reader import StreamReader

import dogbot_logtool as dl
from dogbot_logtool.core.scene.arrows import ARROW_STYLES
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.results import Conversion
from dogbot_logtool.writer.chunks import Compression
from dogbot_logtool.writer.encodings.registry import ENCODINGS
from tests.measured import measured_contact
from tests.oracles import conversion, state_walks, walks
from tests.oracles.annotated_file import (
    Written,
    arrows,
    described_robots,
    read_written,
    written_arrows,
    written_loads,
    written_poses,
)
from tests.oracles.recorded import FEET, TF_TYPE, arrow_topic, read_log
from tests.oracles.small_logs import odd_contacts, small_walk, write_bag, write_ros1_mcap
from tests.oracles.state_walks import StateWalk
from tests.paths import TROT, TROUBLED, WALK

COMPRESSIONS: tuple[Compression, ...] = get_args(Compression)


@dataclass(frozen=True)
class Done:
    conversion: Conversion
    path: Path

    @cached_property
    def written(self) -> Written:
        """What is in the file, which has all that the result counts."""
        written = read_written(self.path)
        annotated = sum(self.conversion.annotations.values())
        assert len(written.messages) == self.conversion.copied + annotated
        return written


_DONE: dict[tuple[Path, str], Done] = {}
_FOLDER = TemporaryDirectory(prefix="converted")


def converted(log: Path, **options: Any) -> Done:
    """Convert a log, once for the same options."""
    key = (log, repr(sorted(options.items())))
    if key not in _DONE:
        target = Path(_FOLDER.name) / f"{len(_DONE)}.mcap"
        conversion = dl.convert(log, target, **options)
        _DONE[key] = Done(conversion, target)
    return _DONE[key]


def opening_of(log: Path) -> int:
    """The first log time, ns."""
    return min(message.log_time for message in read_log(log))


def codes(conversion: Conversion) -> set[str]:
    return {finding.code for finding in conversion.findings}


def chunks_of(path: Path) -> list[records.Chunk]:
    with path.open("rb") as stream:
        return [
            record
            for record in StreamReader(stream, emit_chunks=True).records
            if isinstance(record, records.Chunk)
        ]


IN_WORLD = {TROT: False, WALK: True, TROUBLED: False}
"""Whether wrenches are in the world frame, as the logs' truths say."""
MATRIX = [
    (TROUBLED, "classic", "foxglove"),
    (TROUBLED, "pressure", "ros2"),
    (TROUBLED, "force", "ros1"),
    (WALK, "force", "foxglove"),
]


def assert_same_arrows(
    actual: list[conversion.Arrow], expected: list[conversion.Arrow], style: str, encoding: str
) -> None:
    """Forces are kept with 24 bits, positions with all; the arrows of `classic` are exact."""
    rows = [(arrow.log_time, arrow.stamp, not arrow.position) for arrow in actual]
    assert rows == [(arrow.log_time, arrow.stamp, not arrow.position) for arrow in expected]
    tolerances = {
        "position": (1e-13, 3e-7),
        "orientation": (3e-7, 3e-7),
        "length": (3e-7, 3e-7),
        "colour": (1e-5, 1e-5),
    }
    if style == "classic":
        tolerances = dict.fromkeys(tolerances, (0.0, 0.0))
        if encoding == "foxglove":
            # It is written as shaft and head, which round.
            tolerances["length"] = 1e-13, 1e-12
    for name, (rtol, atol) in tolerances.items():
        kind = np.float32 if name == "colour" else np.float64
        found, wanted = (
            [kind(getattr(arrow, name)) for arrow in arrows if arrow.position]
            for arrows in (actual, expected)
        )
        np.testing.assert_allclose(found, wanted, rtol=rtol, atol=atol, err_msg=name)


def assert_same_poses(
    actual: list[conversion.Pose], expected: list[conversion.Pose], opening: int
) -> None:
    """The first pose also stands at the log's first time, unless it is there already."""
    if expected[0].log_time > opening:
        first = actual.pop(0)
        assert first == replace(expected[0], log_time=opening, stamp=opening)
    assert actual == expected


@pytest.mark.parametrize(
    ("log", "style", "encoding"), MATRIX, ids=[f"{p.stem}-{s}-{e}" for p, s, e in MATRIX]
)
def test_annotations_are_what_message_by_message_conversion_gives(
    log: Path, style: str, encoding: str
) -> None:
    done = converted(log, style=style, encoding=encoding)
    assert done.conversion.damage.exit_code == 0
    for foot in FEET:
        contact = measured_contact(log, foot)
        arrows = conversion.expected_arrows(
            log, foot, style, in_world=IN_WORLD[log], contact=contact
        )
        found = written_arrows(done.written, foot, encoding, style)
        assert_same_arrows(found, arrows, style, encoding)
        loads = written_loads(done.written, foot, encoding)
        # Their forces, the golden files have.
        states = {(load.state, load.in_contact) for load in loads if load.state != "unknown"}
        # Of a dead sensor nothing is known.
        assert states == ({("stance", True), ("swing", False)} if contact else set())
        assert done.conversion.annotations[arrow_topic(foot)] == len(arrows)
    assert done.conversion.annotations["/support"] > 0
    # Legs that transforms move need no lines.
    assert "/legs" not in done.written.topics
    # The logs have a /tf of their own; only transforms of its own ROS fit on it.
    joined = encoding == ("ros2" if log == WALK else "ros1")
    topic = "/tf" if joined else "/dogbot_logtool/tf"
    poses = written_poses(done.written, topic, encoding)
    assert_same_poses(poses, conversion.expected_poses(log, at_ticks=True), opening_of(log))
    assert ("TOPIC_MOVED" in codes(done.conversion)) != joined
    kinds: dict[str, set[tuple[str, str]]] = {}
    for channel in done.written.channels.values():
        kind = done.written.schemas[channel.schema_id].name, channel.message_encoding
        kinds.setdefault(channel.topic, set()).add(kind)
    assert {topic for topic, each in kinds.items() if len(each) > 1} == set()


def test_tf_rate_0_writes_every_pose() -> None:
    done = converted(TROUBLED, tf_rate=0.0, encoding="ros2", copy=False)
    poses = written_poses(done.written, "/tf", "ros2")
    assert_same_poses(
        poses, conversion.expected_poses(TROUBLED, at_ticks=False), opening_of(TROUBLED)
    )


def test_start_and_end_choose_messages_by_log_time() -> None:
    """What is drawn then, the golden files have."""
    first = opening_of(WALK)
    done = converted(WALK, start=2.0005, end=4.25)
    start, end = first + 2_000_500_000, first + 4_250_000_000
    recorded = Counter(each for each in read_log(WALK) if start <= each.log_time <= end)
    assert recorded <= Counter(read_log(done.path))
    assert done.conversion.copied == recorded.total()
    assert described_robots(done.written) == [(start, "dogbot")]


@pytest.mark.parametrize("style", ARROW_STYLES)
def test_forces_of_all_kinds(tmp_path: Path, style: str) -> None:
    log, target = write_bag(tmp_path / "odd.bag", odd_contacts()), tmp_path / "out.mcap"
    given: dict[str, Any] = {"robot": "dogbot", "set": {"wrench_frame": "world"}}
    counts = dl.convert(log, target, style=style, encoding="ros1", **given).counts
    contact = measured_contact(log, "front_left", MeasureOptions(robot="dogbot"))
    expected = conversion.expected_arrows(log, "front_left", style, in_world=True, contact=contact)
    told = written_arrows(read_written(target), "front_left", "ros1", style)
    assert_same_arrows(told, expected, style, "ros1")
    # The touch without a point is too light, and too short, to be a stance.
    found = counts["overflow"], counts["no_position"], counts["not_finite"]
    assert found == ((1, 2, 0) if style == "classic" else (0, 0, 8))


@pytest.mark.parametrize("log", [TROT, WALK], ids=lambda log: log.stem)
def test_neither_jobs_nor_the_folder_leave_a_trace(tmp_path: Path, log: Path) -> None:
    options: dict[str, Any] = {"style": "force"} if log == WALK else {}
    elsewhere, target = tmp_path / "else where", tmp_path / "out"
    for each in (elsewhere, target):
        each.mkdir()
    (elsewhere / log.name).write_bytes(log.read_bytes())
    dl.convert(elsewhere / log.name, target / "x.mcap", jobs=3, **options)
    assert (target / "x.mcap").read_bytes() == converted(log, **options).path.read_bytes()
    assert [file.name for file in target.iterdir()] == ["x.mcap"]


def test_the_doctor_finds_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`pymcap-cli doctor` over all encodings and all compressions, each with both copy modes."""
    from pymcap_cli.cli import app as pymcap_cli  # noqa: PLC0415 - takes long to load

    log = write_ros1_mcap(tmp_path / "log.mcap", small_walk(0.3), extras=True)
    target = tmp_path / "out.mcap"
    encodings = itertools.cycle(ENCODINGS)
    for compression, copy in itertools.product((*COMPRESSIONS, None), (True, False)):
        looks: dict[str, Any] = {
            "encoding": next(encodings),
            "compression": compression,
            "copy": copy,
        }
        dl.convert(log, target, overwrite=True, **looks)
        code = pymcap_cli(["doctor", str(target)], result_action="return_value")
        told = capsys.readouterr()
        assert code == 0, told.out + told.err
        assert "passed MCAP doctor checks" in " ".join(told.out.split())
        assert "warning" not in told.out


# --- Feet whose messages name no frame ------------------------------------------------------------

FT = "pronto_msgs/msg/QuadrupedForceTorqueSensors"
HIPS_M = 0.1
"""Height of a hip above the base, halfway in the chain to the foot."""


def foot_entries(walk: StateWalk) -> Iterator[walks.Entry]:
    """Forces of all feet, and transforms of the base, its hips and its feet."""
    yield from (entry for entry in walk.messages(FT) if entry.kind == FT)
    for sample in range(walks.SAMPLES):
        base = state_walks.base_position(sample)
        rows = [("odom", "base_link", base)]
        for leg, label in state_walks.LABELS.items():
            hip, name = [*state_walks.PLACES[leg], HIPS_M], f"{label[:2].lower()}_hip"
            foot = state_walks.foot_position(leg, sample) - base - hip
            rows += [("base_link", name, hip), (name, label, foot)]
        made = [
            {"header": walk.header(sample, parent), "child_frame_id": child, "transform": [shift]}
            for parent, child, shift in rows
        ]
        message = walk.bytes_of(TF_TYPE, walk.make(TF_TYPE, transforms=made))
        yield walks.Entry("/tf", TF_TYPE, walks.START + sample * walks.STEP, message)


def test_arrows_start_at_the_frames_of_the_feet(tmp_path: Path) -> None:
    walk, path, target = StateWalk(2), tmp_path / "walk.mcap", tmp_path / "out.mcap"
    walks.write_mcap(path, walk, sorted(foot_entries(walk), key=lambda entry: entry.log_time))
    dl.convert(path, target, mass=walks.MASS_KG, encoding="ros2", copy=False)
    drawn = 0
    for topic, log_time, marker in arrows(target):
        leg = topic.removeprefix("/marker_basic_").removesuffix("_foot")
        at = marker.pose.position
        expected = state_walks.foot_position(leg, (log_time - walks.START) // walks.STEP)
        assert (at.x, at.y, at.z) == pytest.approx(expected, abs=1e-6)
        drawn += 1
    assert drawn == sum(int(touch.sum()) for touch in walks.TOUCHES.values())
