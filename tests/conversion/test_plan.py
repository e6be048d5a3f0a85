"""Decisions that are made before the first message is written."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.conversion.plan import ConversionPlan, make_plan, refuse_unknown_names
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame, WrenchFrameEvidence
from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Severity
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.robot.probe import Probe
from dogbot_logtool.robot.probe_findings import probe_findings
from dogbot_logtool.robot.sensors import learn_sensors
from dogbot_logtool.robot.topics.selection import Selection, select_topics
from tests.paths import SAMPLE_LOGS
from tests.probes import probe_log

UNKNOWN = WrenchFrameEvidence(WrenchFrame.UNKNOWN)


@cache
def looked_at(path: Path) -> tuple[Selection, Probe]:
    """Return what a look into a log shows."""
    log = open_log(path)
    selection = select_topics(log, MeasureOptions())
    probe = probe_log(log, selection, with_soles=True)
    log.close()
    return selection, probe


class Case:
    """A sample log with its selection and evidence, to be varied."""

    def __init__(self, path: Path) -> None:
        self.log = open_log(path)
        self.selection, self.probe = looked_at(path)

    def plan(self, **options: Any) -> ConversionPlan:
        wanted = ConvertOptions(**options)
        learnt = learn_sensors(self.selection, self.probe)
        return make_plan(self.log, self.selection, self.probe, learnt, wanted)

    def see(self, **probe: Any) -> None:
        self.probe = replace(self.probe, **probe)

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


def test_frames_are_the_robot_s(trot: Case) -> None:
    trot.see(world_frames=("odom",), base_frames=("trunk",))
    plan = trot.plan()
    assert (plan.world_frame, plan.base_frame) == ("world", "base_link")


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
    trot: Case, recorded: tuple[tuple[str, ...], tuple[str, ...]], used: tuple[str, str]
) -> None:
    trot.know(world_frame=None, base_frame=None)
    trot.see(world_frames=recorded[0], base_frames=recorded[1])
    plan = trot.plan()
    assert (plan.world_frame, plan.base_frame) == used


@pytest.mark.parametrize("tf", ["auto", "always", "never"])
@pytest.mark.parametrize("copy", [True, False])
@pytest.mark.parametrize("parents", [frozenset(), {"world"}, {"map"}, {"map", "world"}])
def test_a_second_parent(trot: Case, tf: str, parents: set[str], *, copy: bool) -> None:
    trot.see(parents={"base_link": frozenset(parents)})
    plan = trot.plan(tf=tf, copy=copy)
    harm = "map" in parents and copy
    assert plan.write_tf == (tf == "always" or (tf == "auto" and not harm))
    assert ("TF_NOT_WRITTEN" in codes(plan)) == (tf == "auto" and harm)


@pytest.mark.parametrize(
    ("option", "seen", "in_world"),
    [
        ("auto", WrenchFrame.WORLD, True),
        ("auto", WrenchFrame.LINK, False),
        ("auto", WrenchFrame.UNKNOWN, False),
        ("world", WrenchFrame.LINK, True),
        ("link", WrenchFrame.WORLD, False),
    ],
)
def test_the_wrench_frame(trot: Case, option: str, seen: WrenchFrame, *, in_world: bool) -> None:
    trot.see(wrench_frame=WrenchFrameEvidence(seen))
    trot.know(wrench_frame=option)
    plan = trot.plan(style="force")
    turns = plan.frames is not None and any(plan.frames.links)
    assert turns == (WrenchFrame.LINK in {option, seen} and not in_world)
    assert ("NOT_DRAWN" in codes(plan)) == (not in_world and not turns)
    (finding,) = (each for each in plan.findings if each.code == "WRENCH_FRAME")
    assert (finding.severity is Severity.WARNING) == (seen is WrenchFrame.UNKNOWN)
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


def test_findings_are_told_by_what_was_seen(trot: Case) -> None:
    trot.see(
        zero_stamps=frozenset({"/dogbot/odom"}),
        slashed_frames=("/map",),
        world_frames=("a", "b"),
        wrench_frame=UNKNOWN,
    )
    found = list(probe_findings(trot.selection, trot.probe))
    assert {each.code for each in found} == {"BAD_STAMPS", "FRAME_NAMES", "WRENCH_FRAME"}
    assert any(each.code == "BAD_STAMPS" and "/dogbot/odom" in each.text for each in found)
    assert any(each.code == "FRAME_NAMES" and "/map" in each.text for each in found)
    assert all(each.severity is Severity.WARNING for each in found)
