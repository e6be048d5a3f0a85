"""What `stats` says, as text and as JSON; and text on terminals of any width."""

import io
import json
import re
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import pyte
import pytest
from jsonschema import Draft202012Validator
from rich.console import Console

import dogbot_logtool as dl
from dogbot_logtool.core.metrics import NEEDS, WalkMetrics
from dogbot_logtool.core.records import to_json
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.loss import Damage, Loss
from dogbot_logtool.report.documents import schema, stats_json
from dogbot_logtool.report.page.render import page
from dogbot_logtool.report.text.gait_diagram import ASCII, gait_diagram
from dogbot_logtool.report.text.stats_text import print_report
from dogbot_logtool.results import Measurement
from tests import forked_cli
from tests.forked_cli import run
from tests.measured import measured, measurement_of
from tests.oracles.small_logs import first_seconds
from tests.paths import TROT, TROUBLED, WALK
from tests.truth.log_file import write_log
from tests.truth.scenes import OneAfterAnother, falling
from tests.truth.walking import Walk as TruthWalk
from tests.truth.walks import WALK as WALKING

SAMPLES: Final = {"trot": TROT, "troubled": TROUBLED, "walk": WALK}
FEET: Final = ("front_left", "front_right", "back_left", "back_right")
TOPICS: Final = {
    "no feet": ("/dogbot/odom",),
    "joints alone": ("/dogbot/joint_states",),
    "two feet": ("/dogbot/front_*", "/dogbot/odom"),
    "no base": ("*contact*", "/tf"),
    "link frame": ("*contact*", "/dogbot/odom"),
}


LACKS: Final = {
    "no feet": ("gait.name", "feet"),
    "joints alone": ("base.path_length_m", "base"),
    "link frame": ("feet.front_left.peak_vertical_force_n", "vertical force"),
}
"""A metric that is null, and what it needs."""


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Measurement]:
    """Return the samples, and the trot with some of its topics only."""
    folder = tmp_path_factory.mktemp("logs")
    found = {name: measured(log) for name, log in SAMPLES.items()}
    for name, topics in TOPICS.items():
        dl.convert(TROT, folder / f"{name}.mcap", topics=topics, tf="never", overwrite=True)
        found[name] = measured(folder / f"{name}.mcap")
    return found


def valid_json(done: Measurement) -> dict[str, Any]:
    """The object as scripts get it: NaN is no JSON."""
    plain = stats_json(done)
    Draft202012Validator.check_schema(schema(WalkMetrics))
    validator = Draft202012Validator(schema(WalkMetrics))
    for document in (plain, to_json(done.metrics, detail=False)):
        validator.validate(document)
    assert not validator.is_valid({**plain, "spin": 1})
    loaded: dict[str, Any] = json.loads(json.dumps(plain, allow_nan=False))
    return loaded


def text_of(done: Measurement, width: int, *, verbose: bool = False) -> str:
    file = io.StringIO()
    print_report(Console(file=file, width=width), done, verbose=verbose)
    return file.getvalue()


@pytest.mark.parametrize("case", [*SAMPLES, *TOPICS])
def test_whatever_is_missing_the_json_is_valid_and_says_why(
    logs: dict[str, Measurement], case: str
) -> None:
    document = valid_json(logs[case])
    assert document["findings"]
    for name, foot in document["feet"].items():
        nulls = {f"feet.{name}.{key}" for key, value in foot.items() if value is None}
        assert nulls <= document["null_because"].keys()
    if case in LACKS:
        key, need = LACKS[case]
        assert document["null_because"][key] == NEEDS[need]


@pytest.mark.parametrize("width", [80, 140])
@pytest.mark.parametrize("case", [*SAMPLES, *TOPICS])
def test_no_line_is_wider_than_the_terminal_and_nothing_is_cut_short(
    logs: dict[str, Measurement], case: str, width: int
) -> None:
    for verbose in (False, True):
        text = text_of(logs[case], width, verbose=verbose)
        lines = text.splitlines()
        too_long = [line for line in lines if len(line) > width and len(line.split()) > 1]
        # Commands stay whole, so that they can be pasted.
        assert [each for each in too_long if not each.startswith("    dogbot-logtool ")] == []
        assert "\u2026" not in text
        assert "\x1b" not in text
        assert sum(line.startswith("Data quality: ") for line in lines) == 1
        if case in {"trot", "walk"} and not verbose:
            assert len(lines) <= 40


def test_what_is_wrong_is_said_worst_first_with_what_to_do() -> None:
    text = " ".join(text_of(measured(TROUBLED), 100).split())
    assert "Data quality: DOUBTFUL (7 warnings, 4 of 9 checks passed" in text
    dead = text.index("- back_left never touches the ground")
    assert dead < text.index("- header stamps are zero") < text.index("2 more warnings (-v)")
    assert "Not given: all of back_left, support" in text
    assert "Not measured load (back_left never touches the ground)" in text


def test_what_the_reader_lost_and_found_is_in_the_quality() -> None:
    said = [Finding("ROBOT_GUESSED", "a robot", ""), Finding("UNREADABLE", "bad", "/x")]
    damage = Damage("a", (Loss(9, "a chunk", 77, None),))
    done = measurement_of(measured(TROT).walk, damage=damage, findings=said)
    document = valid_json(done)
    assert (document["log"]["lost_messages"], document["log"]["lost_bytes"]) == (None, 77)
    assert [each["code"] for each in document["findings"][:2]] == ["UNREADABLE", "LOST"]
    text = text_of(done, 140)
    assert "unknown number of messages and 77 bytes" in text
    assert "Data quality: DAMAGED" in text


def test_the_diagram_tells_what_is_not_known() -> None:
    """When feet are down, the example in the docs has."""
    lines = gait_diagram(measured(TROUBLED).walk, 74, window=(2.0, 4.0), glyphs=ASCII)
    bars = dict(line.plain.split()[:2] for line in lines[:4])
    assert "?" * 20 in bars["front_right"]
    assert set(bars["back_left"]) == {"?"}


def test_a_walk_shorter_than_the_log_is_shown_by_its_longest_segment() -> None:
    """Two halves of the trot are taken for two gaits, as where a robot speeds up."""
    done = measured(TROT)
    (segment,) = done.metrics.gait.segments
    halves = (replace(segment, end_s=3.0), replace(segment, start_s=3.5))
    gait = replace(done.metrics.gait, segments=halves)
    walk = replace(done.walk, metrics=replace(done.metrics, gait=gait))
    text = text_of(Measurement(walk), 100)
    assert "Gait: trot, trot\n" in text
    assert "Longest segment: 3.5 to " in text


def test_a_fall_stands_before_the_gaits(tmp_path: Path) -> None:
    parts = (TruthWalk(), replace(WALKING, seconds=9.0), falling())
    log = write_log(OneAfterAnother(parts).recorded(200.0), tmp_path / "log.mcap")
    done = measured(log, MeasureOptions(mass=20.0))
    text, html = text_of(done, 100), page(done, 0).decode()
    assert text.splitlines()[2:4] == ["Fall at 21.0 s", "Gait: trot, lateral-sequence walk, stand"]
    assert re.search(r"<p>In turn: \d\.\d to \d\.\d s: trot, 1\.25 strides/s; ", html)


# --- Terminals ------------------------------------------------------------------------------------


LONG = "a_log_with_a_name_that_is_longer_than_any_column_of_a_table_in_a_terminal.bag"


@pytest.mark.parametrize(
    "words",
    [
        ["info", "TROUBLED"],
        ["info", "--frames", LONG],
        ["convert", "-v", LONG, "-o", f"x_{LONG}.mcap"],
        ["compare", "TROT", "TROUBLED"],
        ["stats", LONG, "TROUBLED", "--jobs", "1"],
        ["stats", LONG, "-v"],
    ],
    ids=lambda words: words[0],
)
def test_no_command_breaks_a_word(tmp_path: Path, words: list[str]) -> None:
    (tmp_path / LONG).write_bytes(first_seconds(TROT).read_bytes()[:-1000])
    logs = {"TROT": first_seconds(TROT), "TROUBLED": first_seconds(TROUBLED)}
    call = [logs.get(word, word) for word in words]

    def output(columns: int) -> list[str]:
        for file in tmp_path.glob("x_*"):
            file.unlink()
        size = {"COLUMNS": str(columns)}
        done = run(*call, folder=tmp_path, environment=size, stderr=subprocess.STDOUT)
        return done.stdout.splitlines()

    lines = output(80)
    narrow = {word for line in lines for word in line.split()}
    wide = {word for line in output(400) for word in line.split() if word.isprintable()}
    moved = {"type", "sent"}  # headings of columns that have no room
    assert [word for word in wide - narrow - moved if len(word) > 3 and word.isascii()] == []
    assert [line for line in lines if len(line) > 80 and len(line.split()) > 1] == []


# --- On a terminal --------------------------------------------------------------------------------


@pytest.mark.parametrize("logs", [[TROT], [TROT, TROUBLED]], ids=["one", "several"])
@pytest.mark.parametrize("command", ["convert", "stats"])
def test_a_terminal_shows_in_the_end_what_a_pipe_gets(
    tmp_path: Path, command: str, logs: list[Path]
) -> None:
    output = {"convert": ["-o", "./", "--overwrite"]}.get(command, [])
    # What several processes do is shown by any command alike.
    jobs = ["--jobs", "1"] if len(logs) > 1 and command != "stats" else []
    words = [command, *map(str, map(first_seconds, logs)), *output, *jobs]
    size = {"COLUMNS": "160", "LINES": "200", "TERM": "xterm"}
    done = forked_cli.run(*words, folder=tmp_path, environment=size, stderr=subprocess.STDOUT)
    code, shown = forked_cli.run_on_terminal(*words, folder=tmp_path, environment=size)
    assert (done.returncode, code) == (0, 0)

    screen = pyte.Screen(160, 200)
    pyte.Stream(screen).feed(shown.decode())
    assert b"\x1b[2K" in shown, "no progress was shown"
    assert re.search(rb"\x1b\[[\d;]*3\dm", shown), "nothing has a colour"
    assert [line.rstrip() for line in screen.display if line.strip()] == [
        line.rstrip() for line in done.stdout.splitlines() if line.strip()
    ]
