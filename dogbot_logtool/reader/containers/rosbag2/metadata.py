"""The metadata.yaml of a ROS 2 bag: which files it has, and how many messages they hold.

Recorders write it with a line for each fact. It is read by these lines, not as YAML, in which a
kilobyte may stand for gigabytes, and trees may be of any depth. A bag whose metadata was written
in another way is read by the names of its files.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.storage import Location, content
from dogbot_logtool.reader.containers.registry import ROSBAG2_METADATA

_LARGEST: Final = 512 << 10
_LINE: Final = re.compile(r"(?P<indent> *)(?P<item>- )? *(?:(?P<key>\w+):(?: |$))?(?P<value>.*)")
_COUNT: Final = re.compile(r"\d{1,18}")


class UnusableMetadata(Exception):  # noqa: N818 - it never reaches a user; `Loss` does
    """The metadata cannot be used; the text says why."""


@dataclass(frozen=True, slots=True)
class Metadata:
    """Promises of a bag's metadata. Types are taken from the files themselves."""

    files: tuple[str, ...]
    """Names as written; old recorders name a file from the parent directory."""
    distribution: str
    """ROS 2 distribution that recorded it; empty if not stated."""
    messages: int | None
    """In all files; None if not stated."""
    messages_by_file: Mapping[str, int]
    """By the last part of the file's name; newer recorders count these, too."""


def read_metadata(folder: Location) -> Metadata:
    """Read the metadata of the bag in a directory.

    Raises:
        UnusableMetadata: there is none, or it does not name the files.
    """
    lines = _text(folder / ROSBAG2_METADATA).splitlines()
    if "rosbag2_bagfile_information:" not in lines:
        raise UnusableMetadata("it is not what recorders write")
    facts: dict[str, str] = {}
    files: list[str] = []
    described: list[dict[str, str]] = [{}]
    section, base = "", None
    for line in lines[lines.index("rosbag2_bagfile_information:") + 1 :]:
        found = _LINE.match(line)
        indent, item, key, value = found.groups("") if found else ("", "", "", "")
        value = value.strip().strip("'\"")
        base = indent if base is None else base
        if key and not item and indent == base:
            section = key
            facts[key] = value
        elif section == "relative_file_paths" and item and value:
            files.append(value)
        elif section == "files":
            described += [{}] if item else []
            described[-1].setdefault(key, value)
    if "relative_file_paths" not in facts:
        raise UnusableMetadata("it does not name the files")
    messages = facts.get("message_count", "")
    return Metadata(
        files=tuple(files),
        distribution=facts.get("ros_distro", ""),
        messages=int(messages) if _COUNT.fullmatch(messages) else None,
        messages_by_file={
            Path(each["path"]).name: int(each["message_count"])
            for each in described
            if each.get("path") and _COUNT.fullmatch(each.get("message_count", ""))
        },
    )


def _text(path: Location) -> str:
    try:
        data = content(path, _LARGEST)
    except CallError as error:
        raise UnusableMetadata("it is missing or cannot be opened") from error
    except OSError as error:
        raise UnusableMetadata(f"it cannot be read: {error.strerror}") from error
    if data is None:
        raise UnusableMetadata(f"it is larger than {_LARGEST >> 10} kB")
    return data.decode("utf-8-sig", "replace")
