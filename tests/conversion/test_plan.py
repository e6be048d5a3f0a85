"""Decisions that are made before the first message is written."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.commands.stats import measure_log
from dogbot_logtool.conversion.plan import ConversionPlan, make_plan, refuse_unknown_names
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.known_frames import known_frames
from dogbot_logtool.core.recording import Recording
from dogbot_logtool.core.settings import StatsSettings
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.errors import CallError
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.robot.selection import Selection
from tests.paths import SAMPLE_LOGS


@cache
def measured(path: Path) -> tuple[Selection, Stats]:
    """Return what is known of a log once it is measured."""
    log = open_log(path)
    found = measure_log(log, MeasureOptions())
    log.close()
    return found.selection, found.measurement.stats


class Case:
    """A sample log with its selection and walk, to be varied."""

    def __init__(self, path: Path) -> None:
        self.log = open_log(path)
        self.selection, self.walk = measured(path)

    def plan(self, **options: Any) -> ConversionPlan:
        wanted = ConvertOptions(**options)
        return make_plan(self.log, self.selection, self.walk, wanted)

    def see(self, **frames: Any) -> None:
        self.walk = replace(self.walk, frames=replace(self.walk.frames, **frames))

    def know(self, **robot: Any) -> None:
        self.selection = replace(self.selection, robot=replace(self.selection.robot, **robot))


@pytest.fixture
def trot() -> Iterator[Case]:
    case = Case(SAMPLE_LOGS / "dogbot_trot.bag")
    yield case
    case.log.close()


@pytest.fixture
def walk() -> Iterator[Case]:
    case = Case(SAMPLE_LOGS / "dogbot_walk.mcap")
    yield case
    case.log.close()


def codes(plan: ConversionPlan) -> set[str]:
    return {finding.code for finding in plan.findings}


@pytest.mark.parametrize(
    ("recorded", "used"),
    [
        ((("odom",), ("trunk",)), ("odom", "trunk")),
        ((("/odom",), ("/trunk",)), ("odom", "trunk")),
        ((("",), ("",)), ("world", "base_link")),
        ((("/",), ()), ("world", "base_link")),
        ((("", "/map"), ("", "body")), ("map", "body")),
    ],
)
def test_frames_are_the_log_s_where_the_robot_has_none(
    recorded: tuple[tuple[str, ...], tuple[str, ...]], used: tuple[str, str]
) -> None:
    recording = Recording(world_frames=recorded[0], base_frames=recorded[1])
    frames = known_frames(recording, StatsSettings(()))
    assert (frames.world, frames.base) == used
    frames = known_frames(recording, StatsSettings((), world_frame="a", base_frame="b"))
    assert (frames.world, frames.base) == ("a", "b")


@pytest.mark.parametrize("tf", ["auto", "always", "never"])
@pytest.mark.parametrize("copy", [True, False])
@pytest.mark.parametrize("parents", [frozenset(), {"world"}, {"map"}, {"map", "world"}])
def test_a_second_parent(trot: Case, tf: str, parents: set[str], *, copy: bool) -> None:
    trot.see(parents={"base_link": frozenset(parents)})
    plan = trot.plan(tf=tf, copy=copy)
    harm = "map" in parents and copy
    assert plan.write_tf == (tf == "always" or (tf == "auto" and not harm))
    assert ("TF_NOT_WRITTEN" in codes(plan)) == (tf == "auto" and harm)


@pytest.mark.parametrize("seen", WrenchFrame)
def test_the_wrench_frame(trot: Case, seen: WrenchFrame) -> None:
    trot.walk = replace(trot.walk, settings=replace(trot.walk.settings, wrench_frame=seen))
    plan = trot.plan(style="force")
    turns = plan.frames is not None and any(plan.frames.links)
    assert turns == (seen is WrenchFrame.LINK)
    assert ("NOT_DRAWN" in codes(plan)) == (seen is WrenchFrame.UNKNOWN)
    assert "NOT_DRAWN" not in codes(trot.plan(style="pressure"))


@pytest.mark.parametrize(
    ("option", "sentence"),
    [
        (ConvertOptions(style="bold"), "no arrow style 'bold'; known: classic, pressure, force"),
        (ConvertOptions(encoding="xml"), "no encoding 'xml'; known: foxglove, ros1, ros2"),
    ],
)
def test_an_unknown_style_or_encoding_is_a_wrong_call(
    option: ConvertOptions, sentence: str
) -> None:
    with pytest.raises(CallError, match=sentence):
        refuse_unknown_names(option)


def test_weight_and_arrow_style(trot: Case) -> None:
    plan = trot.plan()
    assert plan.body_weight_n == pytest.approx(21.261 * 9.81)
    assert (plan.style.shaft_diameter_m, plan.style.lifetime_s) == (None, 0.5)
    classic = trot.plan(style="classic").style
    assert (classic.shaft_diameter_m, classic.lifetime_s) == (0.1, 0.0)
    trot.know(mass_kg=None)
    plan = trot.plan(style="force")
    assert plan.body_weight_n is None
    assert "MASS_UNKNOWN" in codes(plan)


def test_the_output_begins_where_its_messages_do(walk: Case) -> None:
    assert walk.log.start_time == 5_000_000_000
    assert walk.plan(start=1.5, end=2.0).opening == 6_500_000_000
    assert walk.plan().opening == walk.plan(start=0.0).opening == 5_000_000_000


def test_without_odometry_there_is_no_transform(trot: Case) -> None:
    trot.selection = replace(trot.selection, odometry=())
    assert not trot.plan(tf="always").write_tf
