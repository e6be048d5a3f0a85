"""The figures of a trot in closed form, as JSON, CSV and text."""

import io
import json
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from rich.console import Console

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.metrics import NEEDS, SCHEMA_VERSION, WalkMetrics
from dogbot_logtool.core.settings import FootSettings, WalkSettings
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding, finding_kinds
from dogbot_logtool.reader.containers.loss import Damage, Loss
from dogbot_logtool.report.documents import schema, stats_json
from dogbot_logtool.report.tables import stride_table
from dogbot_logtool.report.text.gait_diagram import ASCII, default_window, gait_diagram
from dogbot_logtool.report.text.stats_text import print_report, print_summary
from dogbot_logtool.report.verdict import summary_row
from tests.analysed import analysed
from tests.measured import LogFacts, measurement_of

START = 1_700_000_000_000_000_000
PLACES = (("front", "left"), ("front", "right"), ("back", "left"), ("back", "right"))
PHASES = (0.0, 0.5, 0.5, 0.0)
FACTS = LogFacts("walks/trot.bag", "ROS 1 bag", "ros1", START / 1e9, 10.0, 8004)


def trot_samples(foot: int, time: Floats) -> Samples:
    """A stride a second from 0.1 s on, down for 0.6 of it with a third of the weight, 196.2 N."""
    cycle = time - 0.098 - PHASES[foot]
    down = cycle % 1.0 < 0.6
    count = len(time)
    up = np.tile([0.0, 0.0, 1.0], (count, 1))
    unknown = np.where(down, 0.0, np.nan)[:, None]
    stamp = START + np.round(time * 1e9).astype(np.int64)
    # In the middle of a stance a foot is at its corner of the base, which goes on.
    ahead = 0.25 * (np.floor(cycle) + 0.398 + PHASES[foot])
    x, y = 0.3 if foot < 2 else -0.3, 0.15 if foot % 2 == 0 else -0.15
    point = np.stack([x + ahead, np.full(count, y), np.zeros(count)], axis=1)
    return Samples(
        foot=np.full(count, foot, np.int64),
        log_time=stamp,
        stamp=stamp,
        in_contact=down,
        force=up * np.where(down, 196.2 / 4.0 / 0.6, 0.0)[:, None],
        in_world=np.zeros(count, np.bool_),
        points=down.astype(np.int64),
        position=point + unknown,
        normal=up + unknown,
    )


def odometry(time: Floats) -> Odometry:
    zero = np.zeros_like(time)
    stamp = START + np.round(time * 1e9).astype(np.int64)
    position = np.stack([0.25 * time, zero, zero + 0.4], axis=1)
    level = np.stack([zero, zero, zero, zero + 1.0], axis=1)
    return Odometry(stamp, stamp, position, level, position * 0.0, position * 0.0)


def measured(
    *, feet: int = 4, with_base: bool = True, wrench_frame: WrenchFrame = WrenchFrame.WORLD
) -> Walk:
    time = np.arange(2001, dtype=np.float64) / 200.0
    names = tuple(FootSettings("_".join(place), f"/{'_'.join(place)}", place) for place in PLACES)
    settings = WalkSettings(names, 20.0, foot_rolling_m=0.0, wrench_frame=wrench_frame)
    samples = [trot_samples(foot, time) for foot in range(feet)]
    poses = odometry(time) if with_base else None
    return analysed(settings, samples, poses)


@pytest.fixture(scope="module")
def trot() -> Walk:
    return measured()


def valid_json(stats: Walk, log: LogFacts = FACTS) -> dict[str, Any]:
    """The object as scripts get it: NaN is no JSON."""
    plain = stats_json(measurement_of(stats, log))
    Draft202012Validator(schema(WalkMetrics)).validate(plain)
    loaded: dict[str, Any] = json.loads(json.dumps(plain, allow_nan=False))
    return loaded


def text_of(stats: Walk, width: int, *, log: LogFacts = FACTS, colour: bool = False) -> str:
    file = io.StringIO()
    console = Console(
        file=file,
        width=width,
        force_terminal=colour,
        color_system="standard" if colour else None,
    )
    print_report(console, measurement_of(stats, log))
    return file.getvalue()


def test_the_schema_is_itself_valid_and_strict() -> None:
    Draft202012Validator.check_schema(schema(WalkMetrics))
    assert all(
        each["additionalProperties"] is False for each in schema(WalkMetrics)["$defs"].values()
    )


def test_the_json_says_what_was_walked(trot: Walk) -> None:
    figures = valid_json(trot)
    assert figures["schema_version"] == SCHEMA_VERSION
    assert figures["gait"]["name"] == "trot"
    assert figures["gait"]["confidence"] == pytest.approx(1.0, abs=0.01)
    assert figures["gait"]["strides"] == 9
    assert figures["gait"]["duty_factor"] == pytest.approx(0.6)
    assert figures["gait"]["diagonality"] == pytest.approx(0.5)
    assert figures["gait"]["phase"]["back_left"]["mean"] == pytest.approx(0.5)
    assert figures["gait"]["support"]["4"] == pytest.approx(0.2, abs=0.01)
    foot = figures["feet"]["front_left"]
    assert foot["touchdown_s"] == pytest.approx([0.1 + stride for stride in range(10)])
    assert foot["lift_off_s"] == pytest.approx([0.7 + stride for stride in range(10)])
    assert foot["strides"] == 9
    assert figures["quality"]["feet"]["front_left"]["discarded_strides"] == {"log_end": 1}
    assert foot["peak_force_bw"]["median"] == pytest.approx(0.25 / 0.6)
    assert foot["stride_length_m"]["mean"] == pytest.approx(0.25)
    assert figures["forces"]["vertical_impulse_over_weight"] == pytest.approx(1.0, abs=0.01)
    assert figures["forces"]["load_share"]["fore"] == pytest.approx(0.5)
    assert figures["forces"]["symmetry_index_percent"]["hind"]["stance_s"] == pytest.approx(0.0)
    assert figures["base"]["forward_speed_mps"] == pytest.approx(0.25)
    assert figures["settings"]["clock"] == "header"
    topic = figures["quality"]["topics"]["/front_left"]
    assert topic["messages"] == 2001


@pytest.mark.parametrize(
    "stats",
    [
        measured(feet=0),
        measured(feet=0, with_base=False),
        measured(feet=2),
        measured(with_base=False),
        measured(wrench_frame=WrenchFrame.LINK),
        analysed(WalkSettings(())),
    ],
    ids=["no feet", "nothing", "two feet", "no base", "link frame", "no robot"],
)
def test_whatever_is_missing_the_json_is_valid_and_the_report_printed(stats: Walk) -> None:
    assert valid_json(stats)["findings"]
    for width in (80, 140):
        assert "Data quality: " in text_of(stats, width)


def test_every_null_of_a_foot_has_a_reason() -> None:
    figures = valid_json(measured(with_base=False, wrench_frame=WrenchFrame.LINK))
    for name, foot in figures["feet"].items():
        nulls = {f"feet.{name}.{key}" for key, value in foot.items() if value is None}
        because = figures["null_because"]
        assert nulls <= because.keys()
        assert because[f"feet.{name}.peak_vertical_force_n"] == NEEDS["vertical force"]


def test_what_the_reader_lost_and_found_is_in_the_quality(trot: Walk) -> None:
    said = [Finding("ROBOT_GUESSED", "a robot", ""), Finding("UNREADABLE", "bad", "/x")]
    damage = Damage("a", (Loss(9, "a chunk", 77, None),))
    log = LogFacts("a", "MCAP", "", None, None, 1, damage, said)
    document = valid_json(trot, log)
    assert (document["log"]["lost_messages"], document["log"]["lost_bytes"]) == (None, 77)
    assert [each["code"] for each in document["findings"][:2]] == ["UNREADABLE", "LOST"]
    assert document["findings"][0] == {
        "code": "UNREADABLE",
        "severity": "error",
        "text": "bad",
        "remedy": finding_kinds()["UNREADABLE"].remedy,
        "where": "/x",
        "voids": [],
    }
    robot = next(each for each in document["findings"] if each["code"] == "ROBOT_GUESSED")
    assert (robot["severity"], robot["where"]) == ("note", None)
    assert "unknown number of messages and 77 bytes" in text_of(trot, 140, log=log)


def test_a_row_a_stride(trot: Walk) -> None:
    strides = stride_table(trot)
    assert len(strides.foot) == sum(len(foot.strides.stance) for foot in trot.feet)
    assert strides.foot[0] == "front_left"
    first = {name: float(column[0]) for name, column in strides.columns.items()}
    assert (first["start_s"], first["duty_factor"], first["slip_m"]) == (0.1, 0.6, 0.0)
    assert first["peak_force_n"] == pytest.approx(196.2 / 4.0 / 0.6)
    assert first["vertical_impulse_ns"] == pytest.approx(196.2 / 4.0)


def test_the_verdict_comes_first(trot: Walk) -> None:
    lines = text_of(trot, 140).splitlines()
    assert lines[0].startswith("trot.bag: ROS 1 bag")
    assert lines[2].startswith("Gait: trot (high confidence: ")
    assert lines[4].startswith("Data quality: ")
    assert len(lines) <= 40


@pytest.mark.parametrize("width", [80, 140])
def test_no_line_is_wider_than_the_terminal_and_nothing_is_cut_short(
    trot: Walk, width: int
) -> None:
    text = text_of(trot, width)
    assert max(len(line) for line in text.splitlines()) <= width
    assert "\u2026" not in text


def test_without_colour_there_are_no_escapes_and_with_it_the_same_words(trot: Walk) -> None:
    plain, coloured = text_of(trot, 100), text_of(trot, 100, colour=True)
    assert "\x1b" not in plain
    assert "\x1b[" in coloured
    for word in ("Gait: trot", "front_left", "Load check"):
        assert word in plain
        assert word in coloured


def test_the_diagram_is_filled_where_feet_are_down(trot: Walk) -> None:
    """Two strides of a second in 60 characters: a foot is down for 18 of each 30."""
    width = 60 + len("front_right ") + 2
    lines = gait_diagram(trot, width, window=(1.1, 3.1), glyphs=ASCII)
    bars = [line.plain.split() for line in lines[:4]]
    down, up = "#" * 18, "." * 12
    assert [name for name, _ in bars] == [foot.name for foot in trot.feet]
    assert bars[0][1] == bars[3][1] == (down + up) * 2
    for bar in (bars[1][1], bars[2][1]):
        assert (bar.count("#"), bar[3:15]) == (36, up)


def test_the_diagrams_axis_has_labels_under_its_ticks(trot: Walk) -> None:
    width = 60 + len("front_right ") + 2
    *_, ruler, labels = gait_diagram(trot, width, window=(1.0, 4.0), glyphs=ASCII)
    ticks = [place for place, glyph in enumerate(ruler.plain) if glyph == "+"]
    assert labels.plain.split() == ["1.0", "1.5", "2.0", "2.5", "3.0", "3.5", "4.0", "s"]
    assert labels.plain[ticks[2] - 1 : ticks[2] + 2] == "2.0"


def test_silence_is_drawn_as_unknown_not_as_swing() -> None:
    lines = gait_diagram(measured(feet=3), 80, window=(1.0, 3.0), glyphs=ASCII)
    assert set(lines[3].plain.split()[1]) == {"?"}


def test_the_window_chosen_is_a_few_strides(trot: Walk) -> None:
    start, end = default_window(trot)
    assert end - start == pytest.approx(4.0)
    assert 0.0 <= start < end <= 10.0


def test_several_logs_have_a_row_each(trot: Walk) -> None:
    file = io.StringIO()
    rows = [summary_row(measurement_of(stats, FACTS)) for stats in (trot, measured(feet=0))]
    print_summary(Console(file=file, width=80), rows)
    lines = file.getvalue().splitlines()
    assert len(lines) == 4
    assert lines[2].split()[:3] == ["trot.bag", "trot", "high"]
