"""ROS 2 bags: a directory of files, and a metadata.yaml that names them."""

import re
from collections.abc import Callable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Final, NamedTuple

from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.io.storage import Location, content, files_in, name_of
from dogbot_logtool.reader.containers.joined_log import JoinedLog
from dogbot_logtool.reader.containers.log import Log
from dogbot_logtool.reader.containers.loss import Loss, lost_messages
from dogbot_logtool.reader.containers.registry import ANNOTATED, ROSBAG2_METADATA, ROSBAG2_SUFFIXES

_LARGEST: Final = 512 << 10
_FILES: Final = r"(?m)^( *)relative_file_paths: *\r?\n((?:\1 *- .*(?:\n|\Z))+)"
"""Its list of files, and how far its keys are indented."""
_COUNT: Final = r"(?a)\d{1,18}"
_PACKED: Final = ".zstd"
_LONGEST_NAME: Final = 255
"""Bytes that a name of a file may have on any disk."""


class UnusableMetadata(Exception):  # noqa: N818 - it never reaches a user; `Loss` does
    """The metadata cannot be used; the text says why."""


class Metadata(NamedTuple):
    """Promises of a bag's metadata. Types are taken from the files themselves."""

    files: tuple[str, ...]
    """Names as written; old recorders name a file from the parent directory."""
    distribution: str
    """ROS 2 distribution that recorded it; empty if not stated."""
    messages: int | None
    """In all files; None if not stated."""


def read_metadata(folder: Location) -> Metadata:
    """Read the metadata of the bag in a directory, as recorders write it, line by line.

    It is not parsed as YAML, in which a kilobyte may stand for gigabytes.

    Raises:
        UnusableMetadata: there is none, or it does not name the files.
    """
    try:
        data = content(folder / ROSBAG2_METADATA, _LARGEST)
    except CallError as error:
        what = str(error).removeprefix(f"{name_of(folder / ROSBAG2_METADATA)}: ")
        raise UnusableMetadata(f"it {what}".replace("it no such file", "it is missing")) from error
    text = data.decode("utf-8-sig", "replace")
    found = re.search(_FILES, text)
    if found is None:
        raise UnusableMetadata("it does not name the files")
    indent, names = found.groups()
    count = _value(text, f"{indent}message_count: ")
    return Metadata(
        files=tuple(_unquoted(line.partition("- ")[2]) for line in names.splitlines()),
        distribution=_value(text, f"{indent}ros_distro: "),
        messages=int(count) if re.fullmatch(_COUNT, count) else None,
    )


def _value(text: str, key: str) -> str:
    """Return what stands behind a key at the beginning of a line; empty: there is none."""
    found = re.search(f"(?m)^{key}(.*)$", text)
    return _unquoted(found[1]) if found else ""


def _unquoted(text: str) -> str:
    return text.strip(" \r'\"")


OpenFile = Callable[[Location, str], Log]
"""Opens a file of a bag, given the distribution of ROS 2 that recorded it; empty: not known."""
_Files = tuple[list[Location], list[Loss]]
"""Of a bag: its files, and what is said of them."""


def open_rosbag2(path: Location, open_file: OpenFile) -> Log:
    """Open the directory of a ROS 2 bag.

    Files that are missing or cannot be read are losses, as long as one can.

    Args:
        path: the directory.
        open_file: opens one of its files.

    Raises:
        CallError: there are no log files in it.
        LogError: none of its files can be read.
    """
    present = {file.name: file for file in files_in(path)}
    try:
        metadata = read_metadata(path)
        files, losses = _named_files(present, metadata)
    except UnusableMetadata as error:
        metadata = Metadata((), "", None)
        files, losses = _numbered_files(path, present, str(error))
    logs: list[Log] = []
    for file in files:
        try:
            logs.append(open_file(file, metadata.distribution))
        except (LogError, CallError) as error:
            losses.append(Loss(0, f"a file of the bag was left out: {error}", 0, None))
    if not logs:
        reason = losses[0].what if losses else f"{ROSBAG2_METADATA} names no files"
        raise LogError(f"{name_of(path)}: nothing of this ROS 2 bag can be read: {reason}")
    losses += _compare_counts(metadata.messages, logs, losses)
    for log, following in pairwise(logs):
        log.losses = tuple(_before(loss, following) for loss in log.losses)
    joined = JoinedLog(path, logs, losses)
    storage = logs[0].container
    joined.container = storage if "ROS 2 bag" in storage else f"ROS 2 bag ({storage})"
    return joined


def _before(loss: Loss, following: Log) -> Loss:
    """End what is missing at the end of a file where the next file begins."""
    is_open = loss.start_time is not None and loss.end_time is None
    return loss._replace(end_time=following.start_time) if is_open else loss


def _named_files(present: Mapping[str, Location], metadata: Metadata) -> _Files:
    """Return the files that metadata names; say which are missing, and which it does not name."""
    logs = [name for name in present if _is_log(name)]
    found = [_present(present, name) for name in metadata.files]
    if logs and not any(found):
        raise UnusableMetadata("it names none of the files that are there")
    missing = [
        Path(name).name for name, file in zip(metadata.files, found, strict=True) if not file
    ]
    files = {file.name: file for file in found if file}
    named = {name.removesuffix(_PACKED) for name in files}
    unnamed = [name for name in logs if name.removesuffix(_PACKED) not in named]
    lost = None if metadata.messages is None else 0
    whats = (
        *((f"names {name[:_LONGEST_NAME]}, which is not there", lost) for name in missing),
        *((f"does not name {name}, so it was left out", None) for name in unnamed),
    )
    losses = [Loss(0, f"{ROSBAG2_METADATA} {what}", 0, count) for what, count in whats]
    return list(files.values()), losses


def _numbered_files(folder: Location, present: Mapping[str, Location], reason: str) -> _Files:
    """Take all log files in the order of their numbers, none both compressed and decompressed."""
    names = [
        name
        for name in present
        if _is_log(name) and not (name.endswith(_PACKED) and name.removesuffix(_PACKED) in present)
    ]
    if not names:
        raise CallError(
            f"{name_of(folder)}: is a directory, not a log file, and holds no ROS 2 bag"
        )
    what = f"{ROSBAG2_METADATA} cannot be used ({reason}); the files were taken by their names"
    return [present[name] for name in sorted(names, key=_by_number)], [Loss(0, what)]


def _compare_counts(
    promised: int | None, logs: Sequence[Log], losses: Sequence[Loss]
) -> Sequence[Loss]:
    """Say where the files hold another number of messages than is promised.

    Messages that other losses explain are not counted twice.
    """
    found = sum(sum(log.counts.values()) for log in logs)
    if promised is None or promised == found:
        return ()
    known = lost_messages([*losses, *(loss for log in logs for loss in log.losses)])
    missing = 0 if known is None else max(promised - found - known, 0)
    what = f"{ROSBAG2_METADATA} counts {promised} messages, but {found} were found"
    return (Loss(0, what, 0, missing),)


def _present(files: Mapping[str, Location], name: str) -> Location | None:
    """Return a file that metadata names; old recorders name it from the parent directory.

    Whatever the name says, the file is in the bag's own directory.
    """
    base = Path(name).name
    candidates = (base, base + _PACKED, base.removesuffix(_PACKED))
    return next((files[each] for each in candidates if each in files), None)


def _by_number(name: str) -> tuple[list[int], str]:
    return [int(digits) for digits in re.findall(r"\d{1,18}", name)], name


def _is_log(name: str) -> bool:
    name = name.removesuffix(_PACKED)
    return name.endswith(ROSBAG2_SUFFIXES) and not name.endswith(ANNOTATED)
