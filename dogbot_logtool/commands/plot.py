"""`stats --figure`: the gait diagram and the load curves of a walk, as a file for a paper."""

from collections.abc import Sequence
from pathlib import Path

from dogbot_logtool.errors import CallError
from dogbot_logtool.io.output import refuse_bad_target, whole_file
from dogbot_logtool.io.storage import Location
from dogbot_logtool.report.gait_figure import FORMATS, gait_figure, require_matplotlib, write_figure
from dogbot_logtool.report.text.gait_diagram import default_window
from dogbot_logtool.results import Measurement


def refuse_bad_figure(target: Path, logs: Sequence[Location], *, overwrite: bool) -> None:
    """Check what can be checked before any work is done.

    Raises:
        CallError: there are several logs, the format is unknown, or the file may not be written.
        ExtraMissingError: matplotlib is not installed.
    """
    if len(logs) != 1:
        raise CallError(f"--figure draws one log, and there are {len(logs)}: call it for each")
    if _format(target) not in FORMATS:
        endings = ", ".join(f".{form}" for form in FORMATS)
        raise CallError(f"--figure {target}: the name must end in one of {endings}")
    refuse_bad_target(target, logs, overwrite=overwrite)
    require_matplotlib()


def draw_figure(measured: Measurement, target: Path, *, overwrite: bool) -> tuple[float, float]:
    """Draw a log that was measured.

    Returns:
        s since the log's start: the window that is drawn.

    Raises:
        LogtoolError: there are no feet, or the file cannot be written.
    """
    stats = measured.walk
    window = default_window(stats)
    figure = gait_figure(stats, window)
    with whole_file(target, overwrite=overwrite) as file:
        write_figure(figure, file, _format(target))
    return window


def _format(target: Path) -> str:
    """Return the format that a name tells: ``svg`` ..."""
    return target.suffix[1:].lower()
