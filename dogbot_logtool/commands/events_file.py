"""`stats --events`: the events of a log as a file."""

from collections.abc import Sequence
from pathlib import Path

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.output import refuse_bad_target, whole_file
from dogbot_logtool.io.storage import Location
from dogbot_logtool.report.figures.figure import Json
from dogbot_logtool.report.files.event_files import event_file


def refuse_bad_events_file(target: Path, logs: Sequence[Location], *, overwrite: bool) -> None:
    """Check what can be checked before any work is done.

    Raises:
        CallError: there are several logs, or the file may not be written.
    """
    if len(logs) != 1:
        count = len(logs)
        raise CallError(f"--events writes those of one log, and there are {count}: use --parquet")
    refuse_bad_target(target, logs[0], overwrite=overwrite)


def write_events_file(target: Path, document: Json, *, overwrite: bool) -> None:
    """Write the events of a log.

    Args:
        target: the file; its suffix chooses the format, see `event_file`.
        document: the log's JSON.
        overwrite: replace a file that is there.

    Raises:
        LogtoolError: it cannot be written, or the format cannot hold the events.
    """
    text = event_file(target.suffix.lower(), document)
    with whole_file(target, overwrite=overwrite) as file:
        file.write(text.encode())
