"""`dogbot-logtool report`: one self-contained HTML page a log, and an index of several."""

from collections.abc import Mapping, Sequence
from contextlib import closing
from typing import Any

from dogbot_logtool.commands.stats import MeasuredLog, measure_log
from dogbot_logtool.io.output import Output, refuse_bad_target, targets, whole_file
from dogbot_logtool.io.storage import Location, file_name, name_of, version
from dogbot_logtool.options.report import Report
from dogbot_logtool.report.page.assets import page_script, shared_name
from dogbot_logtool.report.page.index_page import IndexRow, index, index_row
from dogbot_logtool.report.page.render import ALONE, Beside, page
from dogbot_logtool.report.page.replay import frame_times, replay
from dogbot_logtool.results import Page
from dogbot_logtool.robot.description import find_limbs
from dogbot_logtool.robot.recorded import open_recorded
from dogbot_logtool.run.runner import OnProgress


class Reports:
    """The pages of one call, and the index that leads to them where there are several."""

    def __init__(self, logs: Sequence[Location], output: Output, *, overwrite: bool) -> None:
        """Choose the outputs.

        Raises:
            CallError: several logs would go to one file, or the index may not be written.
        """
        self._targets = dict(targets(logs, output, ".report.html"))
        self._overwrite = overwrite
        self._rows: dict[Location, IndexRow] = {}
        self._index: Location | None = None
        self._beside = ALONE
        if len(logs) > 1:
            self._index = output.path / "index.html"
            refuse_bad_target(self._index, overwrite=overwrite)
            self._beside = Beside(shared_name(), "index.html")

    def write(self, source: Location, options: Report, progress: OnProgress | None = None) -> Page:
        """Measure a log and write its page.

        Args:
            source: one of the logs.
            options: of measuring, and whether there is a replay.
            progress: called with bytes done and bytes in all.

        Raises:
            CallError: no such file, or the target may not be written.
            LogtoolError: the log cannot be used, or the page not be written.
        """
        target = self._targets[source]
        refuse_bad_target(target, [source], overwrite=self._overwrite)
        with closing(open_recorded(source, options.joined)) as log:
            found = measure_log(log, options, progress)
            replay = replay_of(found) if options.replay else None
        measured = found.measurement
        html = page(measured, version(source)[0], replay=replay, beside=self._beside)
        self._share_script()
        with whole_file(target, overwrite=self._overwrite) as file:
            file.write(html)
        self._rows[source] = index_row(measured, file_name(target))
        return Page(source, target, len(html), measured)

    def finish(self, failures: Mapping[str, str]) -> None:
        """Write the index of several logs, a row for each.

        Args:
            failures: why a log has no page, by the log's name as it is shown.
        """
        if self._index is None:
            return
        rows = [self._rows.get(log) or _row_without_page(log, failures) for log in self._targets]
        with whole_file(self._index, overwrite=self._overwrite) as file:
            file.write(index(rows))

    def _share_script(self) -> None:
        """Write the script beside the pages that share it, before the first of them."""
        if self._index is None or self._rows:
            return
        # Its name tells its content: one that is there already is the same.
        script = self._index.parent / self._beside.script
        with whole_file(script, overwrite=True) as file:
            file.write(page_script().encode())


def _row_without_page(log: Location, failures: Mapping[str, str]) -> IndexRow:
    error = failures.get(name_of(log), "no page was written")
    return IndexRow(file_name(log), error=error.removeprefix(f"{name_of(log)}: "))


def replay_of(found: MeasuredLog) -> dict[str, Any] | None:
    """Return what the page's replay draws; None without poses of the base."""
    walk = found.measurement.walk
    if not len(walk.base_history.time):
        return None
    events = found.measurement.metrics.events
    time = frame_times(walk, events)
    return replay(walk, events, time, find_limbs(walk, found.selection, time))
