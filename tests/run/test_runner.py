"""Runners: order, errors as outcomes, and processes that die."""

import os
import signal
import time
from pathlib import Path
from typing import Any

import pytest

from dogbot_logtool.errors import CallError, StoreError
from dogbot_logtool.parallel.relay import Progress
from dogbot_logtool.run.choice import runner_for
from dogbot_logtool.run.processes import Processes
from dogbot_logtool.run.runner import Failure, Runner, attempt


class Watcher:
    def __init__(self) -> None:
        self.sentences: list[str] = []
        self.done: list[int] = []
        self.lost_items: list[int] = []

    def told(self, number: int, done: int, total: int) -> None:
        assert (number >= 0, done, total) == (True, 1, 2)

    def finished(self, number: int) -> None:
        self.done.append(number)

    def lost(self, number: int) -> None:
        self.lost_items.append(number)

    def say(self, sentence: str) -> None:
        self.sentences.append(sentence)


def work(item: tuple[str, Path], tell: Progress | None) -> str:
    what, folder = item
    if tell is not None:
        tell(1, 2)
    match what:
        case "slow":
            time.sleep(0.3)
        case "wrong":
            raise CallError("no such file")
        case "fault":
            raise KeyError(what)
        case "deadly":
            os.kill(os.getpid(), signal.SIGKILL)
        case "deadly once" if not (folder / "died").exists():
            (folder / "died").touch()
            os.kill(os.getpid(), signal.SIGKILL)
    return what.upper()


def outcomes(runner: Runner[Any], folder: Path, *items: str) -> tuple[list[Any], Watcher]:
    watcher = Watcher()
    with runner:
        return list(runner.run(work, [(item, folder) for item in items], watcher)), watcher


def test_one_log_is_done_here_and_many_by_processes() -> None:
    runners = [runner_for(1, 8, None), runner_for(0, 8, None), runner_for(5, 1, None)]
    assert [type(runner).__name__ for runner in runners] == ["Here"] * 3
    assert [runner.jobs for runner in runners] == [8, 8, 1]
    with runner_for(2, 8, None) as runner:
        assert isinstance(runner, Processes)
        assert runner.jobs == 4


def test_here_an_error_is_an_outcome(tmp_path: Path) -> None:
    found, watcher = outcomes(runner_for(4, 1, None), tmp_path, "a", "wrong", "fault", "b")
    assert found[:2] == ["A", Failure("no such file", 2)]
    assert found[2].sentence.startswith("failed by a fault of dogbot-logtool")
    assert found[3] == "B"
    assert watcher.done == [0, 1, 2, 3]


def test_a_process_that_dies_costs_its_own_item_only(tmp_path: Path) -> None:
    items = ("slow", "a", "wrong", "fault", "deadly", "b", "deadly once", "c")
    found, watcher = outcomes(runner_for(len(items), 2, None), tmp_path, *items)
    assert found[:3] == ["SLOW", "A", Failure("no such file", 2)]
    assert found[3].sentence.startswith("failed by a fault of dogbot-logtool")
    assert found[4] == Failure(
        "the process that worked on it died twice: perhaps for want of memory", 1
    )
    assert found[5:] == ["B", "DEADLY ONCE", "C"]
    assert sorted(watcher.done) == list(range(len(items)))
    assert watcher.lost_items == [4, 6]


def test_a_store_that_fails_is_tried_once_more() -> None:
    calls: list[int] = []

    def fails(_item: object, _tell: Progress | None) -> str:
        calls.append(1)
        if len(calls) == 1:
            raise StoreError("the store fails")
        return "done"

    assert attempt(fails, None, lambda _done, _total: None) == "done"

    def always_fails(_item: object, _tell: Progress | None) -> str:
        calls.append(1)
        raise StoreError("the store fails")

    calls.clear()
    failed = attempt(always_fails, None, lambda _done, _total: None)
    assert (failed, len(calls)) == (Failure("the store fails", 1), 2)


@pytest.mark.parametrize("word", ["nonsense", "local:0", "local:", "http://x"])
def test_a_scheduler_is_an_address(word: str) -> None:
    with pytest.raises(CallError, match="must be an address"):
        runner_for(2, 2, word)
