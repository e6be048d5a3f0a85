"""Logs of several batches, of which one holds nothing but messages that cannot be decoded."""

import json
from collections.abc import Callable
from itertools import groupby
from pathlib import Path

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.option import part_of
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.reader.opening import open_log
from tests.forked_cli import run
from tests.oracles import walks
from tests.oracles.walks import Entry

FILLER = "/filler"
BATCHES = 3
GAZEBO = "gazebo_msgs/msg/ContactsState"


def spoiled_walk(folder: Path, kind: str, bad: Callable[[Entry], bool], batch: int) -> Path:
    """Write a walk of three batches; the chosen messages of one of them are cut short."""
    walk = walks.Walk(2)
    store = walk.store
    filler = store.serialize_cdr(
        store.types["std_msgs/msg/String"](data=" " * (8 << 20)), "std_msgs/msg/String"
    )
    entries: list[Entry] = []
    for third, messages in groupby(walks.messages(2, kind), _third):
        for entry in messages:
            cut = entry._replace(data=entry.data[:11])
            entries.append(cut if third == batch and bad(entry) else entry)
        # Fills the chunk up, so that the batch ends with it.
        entries.append(Entry(FILLER, "std_msgs/msg/String", entries[-1].log_time, bytes(filler)))
    path = folder / "walk.mcap"
    walks.write_mcap(path, walk, entries, chunk_size=8 << 20)
    return path


def _third(entry: Entry) -> int:
    return (entry.log_time - walks.START) * BATCHES // (walks.SAMPLES * walks.STEP)


def number_of_batches(path: Path) -> int:
    log = open_log(path)
    try:
        return len(list(log.spans()))
    finally:
        log.close()


def is_odometry(entry: Entry) -> bool:
    return entry.topic == "/odom"


def is_contact(entry: Entry) -> bool:
    return entry.topic != "/odom"


def everything(entry: Entry) -> bool:
    return entry.topic != FILLER


@pytest.mark.parametrize(
    ("kind", "bad"),
    [(GAZEBO, is_odometry), (GAZEBO, is_contact), *((kind, everything) for kind in walks.KINDS)],
)
def test_stats_and_convert_use_what_is_left(
    tmp_path: Path, kind: str, bad: Callable[[Entry], bool]
) -> None:
    path = spoiled_walk(tmp_path, kind, bad, batch=1)
    lost = sum(bad(entry) and _third(entry) == 1 for entry in walks.messages(2, kind))
    topics = MeasureOptions(robot=str(walks.robot_file(tmp_path, kind)))
    measured = measure(path, topics)
    assert measured.damage.exit_code == 3
    assert sum(loss.messages or 0 for loss in measured.damage.losses) == lost
    assert all("could not be decoded" in loss.what for loss in measured.damage.losses)
    done = convert(path, tmp_path / "out.mcap", part_of(topics, ConvertOptions))
    assert done.damage.exit_code == 3
    assert sum(loss.messages or 0 for loss in done.damage.losses) == lost


@pytest.mark.parametrize("batch", range(BATCHES))
def test_every_command_says_the_loss(tmp_path: Path, batch: int) -> None:
    path = spoiled_walk(tmp_path, GAZEBO, everything, batch)
    assert number_of_batches(path) == BATCHES
    for words in (["stats", "--json"], ["convert", "-o", "out.mcap"], ["report", "-o", "out.html"]):
        done = run(*words, path, folder=tmp_path)
        assert done.returncode == 3, done.stderr
        assert "200 messages of /odom could not be decoded" in done.stderr + done.stdout
        if "--json" in words:
            assert json.loads(done.stdout)["log"]["lost_messages"] == 5 * 200
