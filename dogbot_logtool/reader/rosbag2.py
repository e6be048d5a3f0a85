"""ROS 2 bags: a directory of files, and a metadata.yaml that names them."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Protocol

from dogbot_logtool.errors import CallError, LogError
from dogbot_logtool.reader.joined_log import JoinedLog
from dogbot_logtool.reader.log import Log, Loss
from dogbot_logtool.reader.signatures import ROSBAG2_METADATA
from dogbot_logtool.storage import Location, content, files_in, shown

_LARGEST_METADATA: Final = 8 << 20
_SUFFIXES: Final = (".db3", ".mcap")
_PACKED: Final = ".zstd"


class OpenFile(Protocol):
    """Opens one file of a bag."""

    def __call__(self, path: Location, distribution: str) -> Log:
        """Open a file; `distribution` is the one of ROS 2 that recorded it, if known."""


@dataclass(frozen=True, slots=True)
class _Bag:
    """What a bag's metadata tells. Counts and types are taken from the files themselves."""

    files: tuple[Location, ...]
    distribution: str
    losses: tuple[Loss, ...]


def open_rosbag2(path: Location, open_file: OpenFile) -> Log:
    """Open the directory of a ROS 2 bag.

    Files that are missing or cannot be read are losses, as long as one can.

    Raises:
        CallError: there are no log files in it.
        LogError: none of its files can be read.
    """
    bag = _read_metadata(path) or _without_metadata(path)
    logs: list[Log] = []
    losses = list(bag.losses)
    for file in bag.files:
        try:
            logs.append(open_file(file, bag.distribution))
        except (LogError, CallError) as error:
            losses.append(Loss(0, f"a file of the bag was left out: {error}", 0, None))
    if not logs:
        told = losses[0].what if losses else f"{ROSBAG2_METADATA} names no files"
        raise LogError(f"{shown(path)}: nothing of this ROS 2 bag can be read: {told}")
    return JoinedLog(path, logs, losses)


def _read_metadata(folder: Location) -> _Bag | None:
    """Return what metadata tells; None if there is none that can be read."""
    document = _document(folder / ROSBAG2_METADATA)
    information = document.get("rosbag2_bagfile_information")
    information = information if isinstance(information, dict) else {}
    names = information.get("relative_file_paths")
    if not isinstance(names, list):
        return None
    present = {file.name: file for file in files_in(folder)}
    files: list[Location] = []
    losses: list[Loss] = []
    for name in names:
        file = _present(present, str(name))
        if file is None:
            what = f"{ROSBAG2_METADATA} names {Path(str(name)).name}, which is not there"
            losses.append(Loss(0, what, 0, None))
        elif file not in files:
            files.append(file)
    return _Bag(tuple(files), str(information.get("ros_distro") or ""), tuple(losses))


def _document(path: Location) -> dict[str, Any]:
    # Imported late: only directories need it.
    from ruamel.yaml import YAML  # noqa: PLC0415
    from ruamel.yaml.error import YAMLError  # noqa: PLC0415

    try:
        data = content(path, _LARGEST_METADATA)
        if data is None:
            return {}
        document = YAML(typ="safe").load(data.decode("utf-8"))
    except (OSError, CallError, UnicodeDecodeError, YAMLError, ValueError, RecursionError):
        return {}
    return document if isinstance(document, dict) else {}


def _present(files: Mapping[str, Location], name: str) -> Location | None:
    """Return a file that metadata names; old recorders name it from the parent directory.

    Whatever the name says, the file is in the bag's own directory.
    """
    base = Path(name).name
    for candidate in (base, base + _PACKED, base.removesuffix(_PACKED)):
        if candidate in files:
            return files[candidate]
    return None


def _without_metadata(folder: Location) -> _Bag:
    """Take all log files in the order of their numbers."""
    found: list[Location] = [file for file in files_in(folder) if _is_log(file)]
    if not found:
        raise CallError(f"{shown(folder)}: is a directory, not a log file, and holds no ROS 2 bag")
    ordered = sorted(found, key=_by_number)
    what = f"there is no {ROSBAG2_METADATA} that can be read; the files were taken by their names"
    return _Bag(_one_storage(ordered), "", (Loss(0, what, 0, 0),))


def _is_log(file: Location) -> bool:
    name = file.name.removesuffix(_PACKED)
    return name.endswith(_SUFFIXES)


def _by_number(file: Location) -> tuple[list[int], str]:
    return [int(digits) for digits in re.findall(r"\d{1,18}", file.name)], file.name


def _one_storage(files: Sequence[Location]) -> tuple[Location, ...]:
    """Leave out what stands there twice, packed and unpacked."""
    plain = {file.name for file in files}
    return tuple(
        file
        for file in files
        if not (file.name.endswith(_PACKED) and file.name.removesuffix(_PACKED) in plain)
    )
