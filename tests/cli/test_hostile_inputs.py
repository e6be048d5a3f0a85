"""Files that are no regular ones, and small ones that take a parser's time or memory.

Each call ends in bounded time and memory, with an exit code and a sentence.
"""

import os
import re
import resource
from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

import pytest

from dogbot_logtool.robot.robot import load_robot
from tests.forked_cli import run
from tests.oracles.recorded import unpacked
from tests.oracles.walks import Entry, Walk, write_mcap
from tests.paths import TROT, TROUBLED
from tests.reader import bag_bytes, mcap_bytes, sqlite_files
from tests.reader.mcap_bytes import MAGIC, channel, file_header, schema, small_mcap
from tests.shell import Shell, python
from tests.torture.test_commands import COMMANDS

# --- Logs that describe thousands of topics, or whose spans and counts are odd --------------------


YEARS_NS: Final = 56 * 365 * 86400 * 10**9
CONTACTS: Final = "gazebo_msgs/msg/ContactsState"
Writer = Callable[..., None]
"""Writes a log of so many topics, or states."""


def many_channels(path: Path, count: int) -> None:
    channels = b"".join(channel(n, f"/{n}") for n in range(count))
    path.write_bytes(MAGIC + file_header() + schema(1) + channels)


def many_of_a_kind(kind: str, topic: str, path: Path, count: int) -> None:
    walk = Walk(2)
    data = next(entry.data for entry in walk.messages(CONTACTS) if entry.kind == kind)
    entries = (Entry(f"{topic}{n}", kind, n * 1000, data) for n in range(1, count + 1))
    write_mcap(path, walk, entries, 1 << 26)


def descriptions_between_messages(path: Path, count: int) -> None:
    body = b"".join(
        schema(n, data=b"int8 a") + channel(n, f"/{n}") + mcap_bytes.Message(n, n, b"").record()
        for n in range(1, count)
    )
    path.write_bytes(MAGIC + file_header() + body)


def many_connections(path: Path, count: int) -> None:
    inside = b"".join(
        bag_bytes.Connection(n, f"/{n}").record() + bag_bytes.Message(n, n + 1, b"").record()
        for n in range(count)
    )
    head = bag_bytes.MAGIC + bag_bytes.bag_header(0, 0, 0)
    path.write_bytes(head + bag_bytes.chunk(inside, "bz2"))


def many_rows(path: Path, count: int) -> None:
    topics = "INSERT INTO topics SELECT id + 1, '/' || id, 'a/msg/B', 'cdr' FROM messages"
    sqlite_files.make(path, topics, "UPDATE messages SET topic_id = id + 1", rows=count)


MANY_TOPICS: Final[dict[str, tuple[Writer, int]]] = {
    "channels": (many_channels, 8_000),
    "odometries": (partial(many_of_a_kind, "nav_msgs/msg/Odometry", "/o"), 8_000),
    "feet": (partial(many_of_a_kind, CONTACTS, "/front_left_"), 8_000),
    "descriptions between messages": (descriptions_between_messages, 3_000),
    "connections": (many_connections, 20_000),
    "rows": (many_rows, 10_000),
}
"""How each is written, and how many topics are a megabyte at the most."""


def entries(kind: str = "") -> list[Entry]:
    """Return the messages of the trot, or those of a type."""
    return [each for each in unpacked(TROT, 2)[1] if kind in each.kind]


def write(path: Path, rows: Sequence[Entry]) -> None:
    write_mcap(path, unpacked(TROT, 2)[0], rows, 1_000_000)


def set_right(path: Path) -> None:
    """Let the clock of the recorder, which begins in 1970, be set right in the middle."""
    rows = entries()
    half = len(rows) // 2
    late = [each._replace(log_time=each.log_time + YEARS_NS) for each in rows[half:]]
    write(path, rows[:half] + late)


def many_states(path: Path, count: int) -> None:
    """Write a few messages of a foot, each with many contact states."""
    walk, touches = unpacked(TROT, 2)[0], entries(CONTACTS)
    read: Iterator[Any] = (walk.store.deserialize_cdr(each.data, CONTACTS) for each in touches)
    full = next(message for message in read if message.states)
    full.states = [full.states[0]] * count
    data, first = walk.bytes_of(CONTACTS, full), touches[0]
    times = (first.log_time + 10_000_000 * n for n in range(6))
    write(path, [first._replace(log_time=time, data=data) for time in times])


def one_message(path: Path) -> None:
    write(path, entries(CONTACTS)[:1])


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
        assert done.peak_mb < mb, call


# --- Files that are no regular ones ---------------------------------------------------------------


SPECIAL: Final[dict[str, Callable[[Path], None]]] = {
    "a named pipe": os.mkfifo,
    "a device": lambda path: path.symlink_to("/dev/zero"),
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
    said = kind if kind == "a directory" else "a pipe, a socket or a device"
    calls_end(tmp_path, calls, [2], f"s.toml: is {said}, not a regular file")


# --- Files that take a parser's time or memory ----------------------------------------------------

INFO, COMPARE = "info --robot robot.toml LOG", "compare stats.json stats.json"
TEXTS: Final = (
    (INFO, "strange = '''\n" + '"""[\n' * 5000 + "'''\n", "the key strange is not known"),
    (INFO, "mass_kg = " + "9" * 5000, "Exceeds the limit (4300 digits)"),
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
EVERY: Final = tuple(each.format(log="log") for each in COMMANDS[::2])
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
        # The slow test calls all of them.
        f"300 {name}": (partial(writer, count=300), TOPICS[n % 2 :: 2], DONE, "")
        for n, (name, (writer, _)) in enumerate(MANY_TOPICS.items())
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


@pytest.mark.parametrize("words", ["stats TROT --figure out.png", "convert TROT -o out.mcap"])
@pytest.mark.usefixtures("full_disk")
def test_an_output_that_is_too_large_leaves_nothing(shell: Shell, words: str) -> None:
    done = shell(*(TROT if word == "TROT" else word for word in words.split()))
    assert (done.code, done.out, shell.files()) == (1, "", [])
    assert done.err.startswith(f"error: {words.rsplit(maxsplit=1)[-1]}: cannot be written: ")


@pytest.mark.parametrize(
    "words", ["info NAME", "convert NAME -o out/", "compare NAME NAME", "convert TROUBLED -o NAME"]
)
def test_a_name_that_no_disk_takes_is_told(shell: Shell, words: str) -> None:
    names = {"NAME": "x" * 5000, "TROUBLED": TROUBLED}
    done = shell(*(names.get(word, word) for word in words.split()))
    assert done.code in {1, 2}
    assert "File name too long" in done.err
    assert shell.files() == []


@pytest.mark.parametrize("words", ["convert log.mcap", "info ."])
def test_a_current_directory_that_was_removed_is_told(tmp_path: Path, words: str) -> None:
    start = "import os; os.rmdir(os.getcwd()); from dogbot_logtool.__main__ import main; main()"
    done = python("-c", start, *words.split(), folder=tmp_path)
    assert done.code in {1, 2}, done.err
    assert re.search("current directory was removed|no such file", done.err)
