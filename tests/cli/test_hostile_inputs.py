"""Files that are no regular ones, and small ones that take a parser's time or memory.

Each call ends in bounded time and memory, with an exit code and a sentence.
"""

import os
import re
import resource
import socket
import subprocess
import sys
from collections.abc import Callable, Collection, Iterator
from functools import partial
from pathlib import Path
from typing import Final

import pytest

from dogbot_logtool.robot.robot import load_robot
from tests.cli.hostile_logs import (
    MANY_TOPICS,
    many_channels,
    many_states,
    one_message,
    set_right,
)
from tests.forked_cli import run
from tests.paths import ROOT, TROT, TROUBLED
from tests.reader.mcap_bytes import small_mcap
from tests.shell import Shell

MOST_MB: Final = 500
MOST_SECONDS: Final = 60
"""On a busy machine; mostly it is below ten."""
DONE: Final = (0, 1, 3)


def calls_end(
    folder: Path, calls: Collection[str], codes: Collection[int], says: str = "", mb: int = MOST_MB
) -> None:
    """Run calls in a folder; LOG stands for a small log, TROT for a sample."""
    (folder / "walk.mcap").write_bytes(small_mcap().build())
    words = {"LOG": "walk.mcap", "TROT": str(TROT)}
    for call in calls:
        named = [words.get(word, word) for word in call.split()]
        done = run(*named, folder=folder, timeout=MOST_SECONDS)
        assert done.returncode in codes, (call, done.stderr[-1000:])
        assert says in (done.stdout + done.stderr).replace("\n", ""), call
        assert "Traceback" not in done.stderr, call
        assert done.peak_mb < mb, call


# --- Files that are no regular ones ---------------------------------------------------------------


def listening(path: Path) -> None:
    previous = Path.cwd()
    # The name of a socket may be no longer than a hundred bytes.
    os.chdir(path.parent)
    try:
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(path.name)
    finally:
        os.chdir(previous)


SPECIAL: Final[dict[str, Callable[[Path], None]]] = {
    "a named pipe": os.mkfifo,
    "a device": lambda path: path.symlink_to("/dev/zero"),
    "a socket": listening,
    "a directory": Path.mkdir,
}
OPTIONS: Final = (
    "info --robot s.toml LOG",
    "compare --tolerances s.toml LOG LOG",
    "convert --urdf s.toml TROT -o out.mcap",
    "check --limits s.toml LOG",
)
AS_LOGS: Final = ("info s.toml", "convert s.toml", "layout s.toml", "compare LOG s.toml")


@pytest.mark.parametrize("kind", SPECIAL)
def test_files_that_are_not_regular_are_refused(tmp_path: Path, kind: str) -> None:
    SPECIAL[kind](tmp_path / "s.toml")
    calls = OPTIONS if kind == "a directory" else (*OPTIONS, *AS_LOGS)
    calls_end(tmp_path, calls, [2], f"s.toml: is {kind}, not a regular file")


# --- Files that take a parser's time or memory ----------------------------------------------------

INFO, COMPARE = "info --robot robot.toml LOG", "compare stats.json stats.json"
TEXTS: Final = (
    (INFO, "strange = '''\n" + '"""[\n' * 5000 + "'''\n", "the key strange is not known"),
    (INFO, "mass_kg = " + "9" * 5000, "too many digits"),
    (INFO, "mass_kg = 0x" + "f" * 90_000, "mass_kg is too long to show"),
    (INFO, "mass_kg = " + "{a=" * 50_000, "nested too deeply"),
    (INFO, "\n" + "a." * 50_000 + "b = 1", "line 2: a key has more than 16 parts"),
    (INFO, "a" * 200_000 + " = 1", "the key aaa"),
    (INFO, "#" * 300_000, "larger than 256 kB"),
    (COMPARE, '{"a": ' + "9" * 5000 + "}", "value has 5000 digits"),
    (COMPARE, '{"a":' * 5000 + "1" + "}" * 5000, "nested too deeply"),
)


@pytest.mark.parametrize(("call", "text", "says"), TEXTS, ids=lambda each: each[:30])
def test_hostile_texts_are_refused_at_once(tmp_path: Path, call: str, text: str, says: str) -> None:
    (tmp_path / call.split()[-2]).write_text(text)
    calls_end(tmp_path, [call], [1] if call == COMPARE else [2], says)


def test_a_byte_order_mark_does_not_matter(tmp_path: Path) -> None:
    path = tmp_path / "robot.toml"
    path.write_text("name = 'from Windows'\r\nmass_kg = 12.0\r\n", encoding="utf-8-sig")
    assert load_robot(str(path)).name == "from Windows"


# --- Logs of odd spans and counts -----------------------------------------------------------------

TOPICS: Final = ("info --frames log", "stats log", "convert -o out.mcap log", "compare log log")
EVERY: Final = (
    *("info log", "stats log --set clock=log", "stats log --json", "report log -o page.html"),
    *("convert log -o out.mcap", "export log --table events -o events.csv", "check --suggest log"),
)
LOGS: Final[dict[str, tuple[Callable[..., None], Collection[str], Collection[int], str]]] = {
    "a clock set right by 56 years": (set_right, EVERY, (0, 3), ""),
    "30,000 states in a message": (
        partial(many_states, count=30_000), ("stats log", "convert log -o out.mcap"), DONE, ""
    ),
    "one message": (
        one_message, ("stats log --figure figure.svg",), (1,), "there is nothing to draw"
    ),
    "8,000 topics in a table": (
        partial(many_channels, count=8_000), ("info log",), DONE,
        "and 7,000 more topics; --json lists all",
    ),
    **{
        f"300 {name}": (partial(writer, count=300), TOPICS, DONE, "")
        for name, (writer, _) in MANY_TOPICS.items()
    },
}  # fmt: skip


@pytest.mark.parametrize("name", LOGS)
def test_logs_of_odd_spans_and_counts(tmp_path: Path, name: str) -> None:
    make, calls, codes, says = LOGS[name]
    make(tmp_path / "log")
    calls_end(tmp_path, calls, codes, says, 1000)
    assert not (tmp_path / "figure.svg").exists()


@pytest.mark.slow
@pytest.mark.parametrize("name", MANY_TOPICS)
def test_a_megabyte_of_topics_stays_within_bounds(tmp_path: Path, name: str) -> None:
    writer, count = MANY_TOPICS[name]
    writer(tmp_path / "log", count)
    assert (tmp_path / "log").stat().st_size <= 1 << 20
    calls_end(tmp_path, TOPICS, DONE)


# --- Places that cannot be used -------------------------------------------------------------------


@pytest.fixture
def full_disk() -> Iterator[None]:
    """Let files have no more than a few kilobytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.mark.parametrize(
    "words",
    [
        "stats TROT --figure out.png",
        "convert TROT -o out.mcap",
    ],
)
@pytest.mark.usefixtures("full_disk")
def test_an_output_that_is_too_large_leaves_nothing(shell: Shell, words: str) -> None:
    done = shell(*(TROT if word == "TROT" else word for word in words.split()))
    assert (done.code, done.out, shell.files()) == (1, "", [])
    assert done.err.startswith(f"error: {words.rsplit(maxsplit=1)[-1]}: cannot be written: ")


@pytest.mark.parametrize(
    "words",
    [
        "info NAME",
        "convert NAME -o out/",
        "compare NAME NAME",
        "convert TROUBLED -o NAME",
    ],
)
def test_a_name_that_no_disk_takes_is_told(shell: Shell, words: str) -> None:
    names = {"NAME": "x" * 5000, "TROUBLED": TROUBLED}
    done = shell(*(names.get(word, word) for word in words.split()))
    assert done.code in {1, 2}
    assert "File name too long" in done.err
    assert shell.files() == []


@pytest.mark.parametrize("words", ["convert log.mcap", "info ."])
def test_a_current_directory_that_was_removed_is_told(tmp_path: Path, words: str) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    script = f'cd {folder} && rmdir {folder} && exec "$@"'
    done = subprocess.run(  # noqa: S603 - our own interpreter
        ["/bin/sh", "-c", script, "sh", sys.executable, "-m", "dogbot_logtool", *words.split()],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert done.returncode in {1, 2}, done.stderr
    assert re.search("current directory was removed|no such file", done.stderr)
    assert "Traceback" not in done.stderr
