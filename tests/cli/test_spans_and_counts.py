"""Logs of odd spans and counts end in bounded time and memory, with a sentence."""

import resource
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any, Final

import pytest

from tests import forked_cli
from tests.forked_cli import Ended
from tests.oracles.repacked import Message, Recorded, read_bag, write_mcap
from tests.paths import SAMPLE_LOGS
from tests.shell import Shell

MOST_MB: Final = 1000
YEARS_NS: Final = 56 * 365 * 86400 * 10**9
CONTACTS: Final = "gazebo_msgs/msg/ContactsState"
recorded = cache(read_bag)
TROT: Final = SAMPLE_LOGS / "dogbot_trot.bag"


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


@cache
def set_right() -> Recorded:
    """The clock of the recorder, which begins in 1970, is set right in the middle."""
    whole = recorded(TROT)
    half = len(whole.messages) // 2
    late = tuple(replace(each, log_time=each.log_time + YEARS_NS) for each in whole.messages[half:])
    return replace(whole, messages=(*whole.messages[:half], *late))


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
    log = write_mcap(tmp_path / "log.mcap", set_right(), "ros1", 1_000_000)
    done = run(tmp_path, *words.format(log=log).split())
    assert done.returncode in {0, 3}, done.stderr[-500:]


@cache
def many_states(states: int) -> Recorded:
    """A few messages of a foot, each with many contact states."""
    whole = recorded(TROT)
    of_kind = [each for each in whole.messages if each.kind == CONTACTS]
    topic = of_kind[0].topic
    read: list[Any] = [
        whole.types.deserialize_cdr(each.cdr, CONTACTS) for each in of_kind if each.topic == topic
    ]
    full = next(message for message in read if message.states)
    full.states = [full.states[0]] * states
    ros1 = bytes(whole.types.serialize_ros1(full, CONTACTS))
    cdr = bytes(whole.types.serialize_cdr(full, CONTACTS))
    start = whole.messages[0].log_time
    messages = tuple(
        Message(topic, CONTACTS, start + 10_000_000 * number, ros1, cdr) for number in range(6)
    )
    return replace(whole, messages=messages)


@pytest.mark.parametrize("words", ["stats {log}", "convert {log} -o out.mcap"])
def test_thousands_of_contact_states_in_a_message_are_read_in_linear_time(
    tmp_path: Path, words: str
) -> None:
    log = write_mcap(tmp_path / "log.mcap", many_states(30_000), "ros2", 1_000_000)
    done = run(tmp_path, *words.format(log=log).split())
    assert done.returncode in {0, 1, 3}, done.stderr[-500:]


def test_a_figure_of_one_message_says_what_the_log_lacks(tmp_path: Path) -> None:
    whole = recorded(TROT)
    (first, *_) = [each for each in whole.messages if each.kind == CONTACTS]
    log = write_mcap(tmp_path / "log.mcap", replace(whole, messages=(first,)), "ros2", 1_000_000)
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
