"""Real files of other projects, if the machine has them."""

import json
import os
import re
from pathlib import Path
from typing import Any, Final

import pytest

from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.reader.containers.log import Messages
from dogbot_logtool.reader.opening import open_log
from tests.reader.reading import read_file

CORPUS = os.environ.get("LOGTOOL_CORPUS")
pytestmark = pytest.mark.skipif(not CORPUS, reason="LOGTOOL_CORPUS names no folder of real logs")
FOLDER = Path(CORPUS or "absent")


def conformance_files() -> list[Path]:
    return sorted((FOLDER / "conformance").rglob("*.mcap"))


def other_files() -> list[Path]:
    files = [*FOLDER.rglob("*.mcap"), *FOLDER.rglob("*.bag")]
    return sorted(path for path in files if "conformance" not in path.parts)


def records_of(path: Path, kind: str) -> list[dict[str, Any]]:
    described = json.loads(path.with_suffix(".json").read_text())
    return [dict(r["fields"]) for r in described["records"] if r["type"] == kind]


def test_all_conformance_files_are_there() -> None:
    assert len(conformance_files()) == 416


VARIANTS = sorted({path.parent for path in conformance_files()})


@pytest.mark.parametrize("variant", VARIANTS, ids=lambda folder: folder.name)
def test_conformance(variant: Path) -> None:
    for path in sorted(variant.glob("*.mcap")):
        assert_conforms(path)


def assert_conforms(path: Path) -> None:
    log = open_log(path)
    batches = [log.read(span) for span in log.spans()]
    assert [loss for batch in batches for loss in batch.losses] == [], path
    assert not log.losses, path
    found = [
        {
            "channel_id": str(messages.channel[row]),
            "sequence": str(messages.sequence[row]),
            "log_time": str(messages.log_time[row]),
            "publish_time": str(messages.publish_time[row]),
            "data": [str(byte) for byte in payload(batch.buffer, messages, row)],
        }
        for batch in batches
        for messages in [batch.messages]
        for row in range(len(messages))
    ]
    assert found == records_of(path, "Message"), path
    channels = {int(channel["id"]): channel for channel in records_of(path, "Channel")}
    assert log.channels.keys() == channels.keys(), path
    for number, channel in log.channels.items():
        assert channel.topic == channels[number]["topic"]
        assert channel.metadata == channels[number]["metadata"]
        assert (channel.schema.id if channel.schema else 0) == int(channels[number]["schema_id"])
    extras = [*records_of(path, "Attachment"), *records_of(path, "Metadata")]
    assert len(log.extras) == len(extras), path
    log.close()


def payload(buffer: Any, messages: Messages, row: int) -> bytes:
    return bytes(buffer[int(messages.start[row]) : int(messages.end[row])])


@pytest.mark.parametrize("path", other_files(), ids=lambda path: path.name)
def test_every_other_file_opens_or_gives_a_sentence(path: Path) -> None:
    try:
        reading = read_file(path)
    except LogtoolError as error:
        assert "\n" not in str(error)  # noqa: PT017 - an error is one of two good outcomes
        return
    assert sum(reading.counts.values()) == len(reading.messages)
    # Some recordings were not closed, which costs no message.
    lost = [loss for loss in reading.losses if "has no index" not in loss.what]
    if "truncated" not in path.name and "unindexed" not in path.name:
        assert not lost


OTHER_VERSION: Final = re.compile(r"^metadata\.yaml does not name \S+@\w+\.\w+, so")


def rosbag2_logs() -> list[Path]:
    """Return the directories of ROS 2 bags, and the databases that have none."""
    bags = {path.parent for path in FOLDER.rglob("metadata.yaml")}
    alone = [path for path in FOLDER.rglob("*.db3*") if path.parent not in bags]
    return sorted([*bags, *alone])


@pytest.mark.parametrize("path", rosbag2_logs(), ids=lambda path: str(path.relative_to(FOLDER)))
def test_rosbag2_holds_what_its_metadata_promises(path: Path) -> None:
    reading = read_file(path)
    assert sum(reading.counts.values()) == len(reading.messages)
    # The corpus keeps other versions of a file, marked with an @, beside it.
    assert [loss for loss in reading.losses if not OTHER_VERSION.search(loss.what)] == []
