"""Names from logs, robots' files and URLs reach no terminal or spreadsheet as they are."""

import csv
import io
import json
import os
import re
import shlex
from collections.abc import Sequence
from pathlib import Path

import pytest
from mcap.writer import CompressionType

from tests.comparison.recordings import Kind, Recording
from tests.forked_cli import run, run_on_terminal
from tests.oracles.recorded import read_log
from tests.oracles.small_logs import odometry_log
from tests.paths import TROT, WALK
from tests.shell import Shell

SECONDS = 3
EVIL = "\x1b]0;sent\x07\x1b[8m\x9b31m\u202e\u2028\x7f"
"""A title for the terminal, hidden text, a C1 code, text from right to left, a line, a DEL."""
BASE = "\x1b[31mlink"
SEQUENCE = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
"""Colours and cursor movements, which a terminal may get from us."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a log, a cut one and a robot's file that are all hostile."""
    folder = tmp_path_factory.mktemp("hostile")
    log = folder / f"=walk\n{EVIL}[red].mcap"
    _write_hostile(log)
    (folder / f"cut{EVIL}.mcap").write_bytes(log.read_bytes()[:-200_000])
    (folder / f"bad\n{EVIL}.bag").write_text(f"no log {EVIL}", encoding="utf-8")
    robot = run("robots", "dogbot").stdout.replace("/dogbot/", f"/{_in_toml(EVIL)}/")
    robot = robot.replace("[feet.front_left]", f'[feet."=front\\n{_in_toml(EVIL)}"]')
    robot = robot.replace('name = "dogbot"', f'name = "dogbot\\n{_in_toml(EVIL)}"')
    robot = robot.replace('base = "base_link"', f'base = "{_in_toml(BASE)}"')
    (folder / f"robot{EVIL}.toml").write_text(robot, encoding="utf-8")
    return folder


def _in_toml(text: str) -> str:
    return "".join(f"\\u{ord(character):04x}" for character in text)


def _write_hostile(path: Path) -> None:
    """Copy the walk's first seconds with other topics, and with frames of the same length."""
    kinds, messages, walk = {}, [], read_log(WALK)
    for each in walk:
        topic = each.topic.replace("dogbot", EVIL)
        kinds[topic] = Kind("cdr", each.type_name, "ros2msg", each.definition.encode())
        if each.log_time <= walk[0].log_time + SECONDS * 10**9:
            data = each.data.replace(b"base_link", BASE.encode()).replace(b"leg", b"\xc2\x9bm")
            messages.append((topic, each.log_time, data))
    recording = Recording(kinds, messages, profile=f"ros1{EVIL}")
    recording.write(path, compression=CompressionType.NONE)


ROBOT = ["--robot", f"robot{EVIL}.toml"]
CALLS = {
    "info frames": ["info", "--frames", *ROBOT],
    "stats": ["stats", "-v", *ROBOT],
    "csv": ["export", *ROBOT],
    "convert": ["convert", "-v", "-o", "./", "--overwrite", *ROBOT],
    "report": ["report", "-v", "-o", "./", "--overwrite"],
    "layout": ["layout", *ROBOT],
    "compare": ["compare"],
    "no such robot": ["convert", "--robot", EVIL],
    "wrong value": ["convert", "--style", EVIL],
}


def command(words: Sequence[str], count: int) -> list[str]:
    """Return the words of a call with the first of the logs; `convert` takes several processes."""
    logs = [f"=walk\n{EVIL}[red].mcap", f"cut{EVIL}.mcap", f"bad\n{EVIL}.bag"]
    count = {"layout": 1, "compare": 2}.get(words[0], count)
    alone = ["--jobs", "1"] if words[0] in {"export", "info", "stats", "report"} else []
    return [*words, *alone, *logs[:count]]


@pytest.mark.parametrize("words", CALLS.values(), ids=CALLS)
def test_no_control_character_is_printed(folder: Path, words: list[str]) -> None:
    """Nor on a terminal, but for our own sequences."""
    done = run(*command(words, 3), folder=folder)
    text = done.stdout + done.stderr
    assert done.returncode in {0, 1, 2, 3}
    assert [line for line in text.split("\n") if line.startswith(("\\x1b", EVIL[1:]))] == []
    _, shown = run_on_terminal(*command(words, 1), folder=folder, environment={"TERM": "xterm"})
    on_terminal = shown.decode("utf-8")
    assert "\x1b[8m" not in on_terminal
    assert BASE not in on_terminal
    for each in (text, SEQUENCE.sub("", on_terminal).replace("\r", "")):
        assert "Traceback" not in each
        assert [c for c in each if not c.isprintable() and c != "\n"] == []


def test_the_command_of_a_new_robot_can_be_pasted(tmp_path: Path) -> None:
    """Where a name has control characters, it is only shown."""
    for name, file in (("it's $HOME\\x41é.mcap", "a b.toml"), (f"{EVIL}.mcap", f"{EVIL}.toml")):
        (tmp_path / name).write_bytes(WALK.read_bytes())
        drafted = run("robots", "new", name, "-o", file, folder=tmp_path)
        (printed,) = drafted.stderr.splitlines()
        assert printed.isprintable()
        if name.isprintable():
            expected = ["dogbot-logtool", "stats", name, "--robot", file]
            assert shlex.split(printed) == expected


def test_text_in_csv_is_no_formula(folder: Path) -> None:
    done = run(*command(["export", *ROBOT], 1), folder=folder)
    assert done.returncode == 0
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    assert {row["log"][:6] for row in rows} == {"'=walk"}
    assert {row["foot"] for row in rows if "front" in row["foot"]} > {"front_right"}
    assert [row for row in rows if row["foot"].startswith("'=front\\n")]
    for row in rows:
        for name, cell in row.items():
            assert name in {"log", "foot"} or not cell or isinstance(float(cell), float)


def test_names_with_markup_and_odd_bytes(shell: Shell) -> None:
    name = os.fsdecode(b"[bold]\xff.mcap")
    odometry_log(shell.folder / name, "/[red]odom[/red]")
    done = run("info", name, folder=shell.folder)
    assert (done.returncode, done.stderr) == (0, "")
    assert "/[red]odom[/red]" in done.stdout
    assert "[bold]" in done.stdout
    done = run("convert", name, "--json", folder=shell.folder)
    assert done.returncode == 0
    assert (
        json.loads(done.stdout)["annotations"].items()
        >= {"/tf": 10, "/robot_description": 1}.items()
    )


# --- Passwords and signatures ---------------------------------------------------------------------


QUERY = "?signature=SECRET&x=SECRET"
URL = f"http://user:SECRET@127.0.0.1:1/a.bag{QUERY}"


@pytest.mark.parametrize(
    "words",
    [
        ["info", URL.replace("127.0.0.1:1", "[bad")],
        ["info", f"gopher://user:SECRET@host/a.bag{QUERY}"],
        ["info", f"simplecache::{URL}"],
        ["info", f"zip://a.bag::{URL}"],
        ["stats", str(TROT), "--robot", URL],
        ["stats", str(TROT), "--figure", URL],
        ["stats", str(TROT), "--scheduler", URL],
        ["stats", str(TROT), "--scheduler", "tcp://user:SECRET@127.0.0.1:1"],
        ["compare", URL, URL],
        ["compare", str(TROT), str(TROT), "--tolerances", URL],
        ["compare", str(TROT), str(TROT), "--junit", URL],
        ["layout", "-o", URL],
        ["robots", URL],
    ],
    ids=" ".join,
)
def test_no_error_shows_them(words: list[str]) -> None:
    done = run(*words)
    assert done.returncode in {1, 2}
    assert done.stderr.startswith(("error: ", "Usage: "))
    assert "SECRET" not in done.stdout + done.stderr
