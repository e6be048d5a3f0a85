"""Journals and schemas made by hand that would have SQLite write, delete, hang or swell."""

import os
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Final

import pytest

from tests import forked_cli
from tests.forked_cli import Ended
from tests.reader.reading import read_file
from tests.reader.sqlite_files import contents, expected, make

MOST_MB: Final = 500
PAGE: Final = 4096
SECTOR: Final = 512
MAGIC: Final = bytes.fromhex("d9d505f920a163d7")
LOCK_PAGE: Final = (1 << 30) // PAGE + 1


def journal(pages: int, records: bytes = b"", count: int = 0, tail: bytes = b"") -> bytes:
    head = MAGIC + struct.pack(">5I", count, 7, pages, SECTOR, PAGE)
    return head.ljust(SECTOR, b"\0") + records + tail


def saved(number: int, page: bytes) -> bytes:
    total = 7 + sum(page[at] for at in range(PAGE - 200, 0, -200))
    return struct.pack(">I", number) + page + struct.pack(">I", total & 0xFFFFFFFF)


def super_journal(name: bytes) -> bytes:
    total = sum(name) & 0xFFFFFFFF
    return struct.pack(">I", LOCK_PAGE) + name + struct.pack(">2I", len(name), total) + MAGIC


def run(folder: Path, *words: str) -> Ended:
    """Run the program, which must end within ten seconds and half a gigabyte."""
    scratch = {"TMPDIR": str(folder / "scratch")}
    done = forked_cli.run(*words, folder=folder, environment=scratch, timeout=10.0)
    assert done.peak_mb < MOST_MB
    return done


def changes_nothing(folder: Path, log: Path, beside: bytes, command: str) -> None:
    """Run a command on a log with a journal; no file anywhere is another one then."""
    log.with_name("log.db3-journal").write_bytes(beside)
    before = contents(folder)
    words = [*command.split(), str(log), *([str(log)] if command == "compare" else [])]
    done = run(folder / "work", *words)
    assert done.returncode in {0, 1, 3}, done.stderr
    assert contents(folder) == before


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("work/scratch", "logs", "victim"):
        (tmp_path / name).mkdir(parents=True)
    (tmp_path / "victim" / "keep").write_bytes(MAGIC + b"of great value")
    (tmp_path / "work" / "keep").write_bytes(MAGIC + b"of great value")
    os.mkfifo(tmp_path / "victim" / "pipe")
    return tmp_path


@pytest.mark.parametrize("command", ["info", "stats", "convert -o out.mcap", "compare"])
@pytest.mark.parametrize(
    "victim", ["{folder}/victim/keep", "keep", "../victim/keep", "log.db3", "{folder}/victim/pipe"]
)
def test_the_name_of_another_journal_is_never_followed(
    folder: Path, victim: str, command: str
) -> None:
    log = make(folder / "logs" / "log.db3")
    page = log.read_bytes()[:PAGE]
    name = victim.format(folder=folder).encode()
    count = log.stat().st_size // PAGE
    changes_nothing(folder, log, journal(count, saved(1, page), 1, super_journal(name)), command)


@pytest.mark.parametrize(
    ("place", "says"),
    [
        (20, "its header is damaged"),
        (24, "those of the database 4096"),
        (SECTOR + PAGE - 198, "tells what rows were before they were written"),
    ],
)
def test_damage_in_a_journal_is_said(tmp_path: Path, place: int, says: str) -> None:
    log = make(tmp_path / "log.db3")
    data = bytearray(journal(2, saved(1, bytes(PAGE)), 1))
    data[place : place + 4] = struct.pack(">I", 512 + 7 * (place == 20))
    log.with_name("log.db3-journal").write_bytes(data)
    reading = read_file(log)
    assert says in reading.sentences
    assert list(reading.messages) == expected()


@pytest.mark.parametrize("pages", [1 << 27, (1 << 32) - 1])
@pytest.mark.parametrize("count", [0, (1 << 32) - 1])
def test_a_journal_makes_no_log_larger(folder: Path, pages: int, count: int) -> None:
    log = make(folder / "logs" / "log.db3")
    changes_nothing(folder, log, journal(pages, count=count), "compare")


NO_JOURNALS: Final[dict[str, Callable[[Path], object]]] = {
    "byte": lambda path: path.write_bytes(b"\x37"),
    "link": lambda path: path.symlink_to("/dev/zero"),
    "pipe": os.mkfifo,
    "folder": Path.mkdir,
}


@pytest.mark.parametrize("suffix", ["-wal", "-journal"])
@pytest.mark.parametrize("kind", NO_JOURNALS)
def test_what_is_no_journal_is_left_alone(folder: Path, suffix: str, kind: str) -> None:
    log = make(folder / "logs" / "log.db3")
    NO_JOURNALS[kind](folder / "logs" / f"log.db3{suffix}")
    done = run(folder / "work", "info", str(log))
    assert done.returncode in {0, 3}, done.stderr
    assert "/a" in done.stdout


@pytest.mark.parametrize("cut", [0, PAGE])
def test_a_view_behind_the_name_of_a_table_is_no_table(folder: Path, cut: int) -> None:
    log = make(
        folder / "logs" / "log.db3",
        "ALTER TABLE topics RENAME TO own",
        "CREATE VIEW topics AS SELECT 1 AS id, printf('%.*c', 900000000, 'x') AS name, "
        "'std_msgs/msg/String' AS type, 'cdr' AS serialization_format",
        rows=5000,
    )
    if cut:
        log.write_bytes(log.read_bytes()[:-cut])
    done = run(folder / "work", "info", str(log))
    assert done.returncode in {1, 3}, done.stderr
    assert not list((folder / "work" / "scratch").iterdir())
