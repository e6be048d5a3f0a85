"""The metadata.yaml of a ROS 2 bag: which files it has, and how many messages they hold."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.storage import Location, content
from dogbot_logtool.reader.containers.registry import ROSBAG2_METADATA

if TYPE_CHECKING:
    from ruamel.yaml.events import Event

_LARGEST: Final = 512 << 10
_MOST_EVENTS: Final = 60_000
"""A bag of a hundred topics and a hundred files has some three thousand."""
_DEEPEST: Final = 32
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
    document = _document(folder / ROSBAG2_METADATA)
    information = _mapping(_mapping(document).get("rosbag2_bagfile_information"))
    names = information.get("relative_file_paths")
    if not isinstance(names, list):
        raise UnusableMetadata("it does not name the files")
    return Metadata(
        files=tuple(name for name in names if isinstance(name, str)),
        distribution=_text(information.get("ros_distro")),
        messages=_count(information.get("message_count")),
        messages_by_file=dict(_counts_by_file(information.get("files"))),
    )


def _document(path: Location) -> object:
    # Imported late: only directories need it.
    from ruamel.yaml import YAML  # noqa: PLC0415
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415

    try:
        data = content(path, _LARGEST)
        if data is None:
            raise UnusableMetadata(f"it is larger than {_LARGEST >> 10} kB")
        return _first_document(YAML(typ="base").parse(data.decode("utf-8-sig")))
    except CallError as error:
        raise UnusableMetadata("it is missing or cannot be opened") from error
    except OSError as error:
        raise UnusableMetadata(f"it cannot be read: {error.strerror}") from error
    except (YAMLError, ValueError) as error:
        raise UnusableMetadata("it is not YAML") from error


def _first_document(events: Iterator["Event"]) -> object:
    """Build plain values from the events of a parser; every scalar is a text.

    The loaders of the library are not used: they follow aliases, through which a kilobyte may
    stand for gigabytes, and build trees of any depth.
    """
    from ruamel.yaml import events as kinds  # noqa: PLC0415

    root: list[Any] = []
    path: list[list[Any]] = [root]
    for number, event in enumerate(events):
        if number >= _MOST_EVENTS or len(path) > _DEEPEST:
            raise UnusableMetadata("it is too long or too deeply nested")
        if isinstance(event, kinds.AliasEvent):
            raise UnusableMetadata("it has aliases, which no recorder writes")
        if isinstance(event, kinds.ScalarEvent):
            path[-1].append(event.value)
        elif isinstance(event, kinds.CollectionStartEvent):
            path.append([])
        elif isinstance(event, kinds.CollectionEndEvent):
            items = path.pop()
            is_sequence = isinstance(event, kinds.SequenceEndEvent)
            path[-1].append(items if is_sequence else _pairs(items))
        elif isinstance(event, kinds.DocumentEndEvent):
            break
    return root[0] if root else None


def _pairs(items: list[Any]) -> dict[str, Any]:
    """Return a mapping of keys and values in turn; keys that are no texts are left out."""
    pairs = zip(items[::2], items[1::2], strict=True)
    return {key: value for key, value in pairs if isinstance(key, str)}


def _mapping(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, dict) else {}


def _text(value: object) -> str:
    return value if isinstance(value, str) else ""


def _count(value: object) -> int | None:
    return int(value) if isinstance(value, str) and _COUNT.fullmatch(value) else None


def _counts_by_file(files: object) -> Iterator[tuple[str, int]]:
    for file in files if isinstance(files, list) else []:
        facts = _mapping(file)
        name, count = _text(facts.get("path")), _count(facts.get("message_count"))
        if name and count is not None:
            yield Path(name).name, count
