"""Logs of odd spans and counts end in bounded time and memory, with a sentence."""

import resource
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import pytest

from tests import forked_cli
from tests.forked_cli import Ended
from tests.oracles.repacked import unpacked
from tests.oracles.walks import Entry, write_library_mcap
from tests.paths import TROT
from tests.shell import Shell

MOST_MB: Final = 1000
YEARS_NS: Final = 56 * 365 * 86400 * 10**9
CONTACTS: Final = "gazebo_msgs/msg/ContactsState"


def run(folder: Path, *words: str) -> Ended:
    """Run the program, which must end within half a minute and a gigabyte."""
    done = forked_cli.run(*words, folder=folder, timeout=30.0)
    assert done.peak_mb < MOST_MB
    assert "Traceback" not in done.stderr
    return done


@pytest.fixture
def full_disk() -> Iterator[None]:
    """Let files have no more than a few kilobytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


def entries(kind: str = "") -> list[Entry]:
    """The messages of the trot, or those of a type."""
    return [each for each in unpacked(TROT, 2)[1] if kind in each.kind]


def write(folder: Path, entries: Sequence[Entry]) -> Path:
    return write_library_mcap(folder / "log.mcap", unpacked(TROT, 2)[0], entries, 1_000_000)


def set_right() -> list[Entry]:
    """The clock of the recorder, which begins in 1970, is set right in the middle."""
    rows = entries()
    half = len(rows) // 2
    late = [each._replace(log_time=each.log_time + YEARS_NS) for each in rows[half:]]
    return rows[:half] + late


@pytest.mark.parametrize(
    "words",
    [
        "info {log}",
        "stats {log} --set clock=log",
        "stats {log} --json",
        "report {log} -o page.html",
        "convert {log} -o out.mcap",
        "export {log} --table events -o events.csv",
        "check --suggest {log}",
    ],
)
def test_a_clock_that_is_set_right_by_56_years_costs_nothing(tmp_path: Path, words: str) -> None:
    log = write(tmp_path, set_right())
    done = run(tmp_path, *words.format(log=log).split())
    assert done.returncode in {0, 3}, done.stderr[-500:]


def many_states(states: int) -> list[Entry]:
    """A few messages of a foot, each with many contact states."""
    walk, touches = unpacked(TROT, 2)[0], entries(CONTACTS)
    read: Iterator[Any] = (walk.store.deserialize_cdr(each.data, CONTACTS) for each in touches)
    full = next(message for message in read if message.states)
    full.states = [full.states[0]] * states
    data, first = walk.bytes_of(CONTACTS, full), touches[0]
    return [first._replace(log_time=first.log_time + 10_000_000 * n, data=data) for n in range(6)]


@pytest.mark.parametrize("words", ["stats {log}", "convert {log} -o out.mcap"])
def test_thousands_of_contact_states_in_a_message_are_read_in_linear_time(
    tmp_path: Path, words: str
) -> None:
    log = write(tmp_path, many_states(30_000))
    done = run(tmp_path, *words.format(log=log).split())
    assert done.returncode in {0, 1, 3}, done.stderr[-500:]


def test_a_figure_of_one_message_says_what_the_log_lacks(tmp_path: Path) -> None:
    log = write(tmp_path, entries(CONTACTS)[:1])
    done = run(tmp_path, "stats", str(log), "--figure", "figure.svg")
    assert done.returncode == 1, done.stderr
    assert "--window" not in done.stderr
    assert not (tmp_path / "figure.svg").exists()


@pytest.mark.parametrize(
    ("words", "target"),
    [
        ("stats {log} --figure out.png", "out.png"),
        ("convert {log} -o out.mcap", "out.mcap"),
        ("report {log} -o out.html", "out.html"),
        ("export {log} --table samples -o out.csv", "out.csv"),
    ],
)
@pytest.mark.usefixtures("full_disk")
def test_an_output_that_is_too_large_leaves_nothing(shell: Shell, words: str, target: str) -> None:
    done = shell(*words.format(log=TROT).split())
    assert (done.code, done.out, shell.files()) == (1, "", [])
    assert done.err.startswith(f"error: {target}: cannot be written: ")
