"""`dogbot-logtool report`: one self-contained HTML page a log, and an index of several."""

from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import BinaryIO, Final

from dogbot_logtool.closer_look import with_detail
from dogbot_logtool.core.curves import CurveDetail
from dogbot_logtool.errors import LogtoolError
from dogbot_logtool.parallel.relay import Progress
from dogbot_logtool.report.gait_diagram import default_window
from dogbot_logtool.report.page.render import IndexRow, Place, index, index_row, page
from dogbot_logtool.stats import Measurement, StatsOptions, measure
from dogbot_logtool.storage import Location, file_name, is_folder, version
from dogbot_logtool.writer.output import refuse_bad_target, whole_file
from dogbot_logtool.writer.targets import Output, targets

DETAIL: Final = CurveDetail()
"""Half a minute at 250 Hz sample by sample; four feet make a page of up to 8 MB."""


@dataclass(frozen=True, slots=True)
class Page:
    """A page that was written."""

    source: Location
    target: Location
    size: int
    """bytes."""
    measured: Measurement

    @property
    def exit_code(self) -> int:
        """0: done; 3: done, but the log was damaged."""
        return self.measured.exit_code


class Reports:
    """The pages of one call, and the index that leads to them where there are several."""

    def __init__(
        self,
        logs: Sequence[Location],
        output: Output,
        options: StatsOptions,
        *,
        overwrite: bool,
    ) -> None:
        """Choose the outputs.

        Raises:
            CallError: several logs would go to one file, or the index may not be written.
        """
        self._targets = dict(targets(logs, output, ".report.html"))
        self._options = replace(options, curves=DETAIL)
        self._makes_folder = output.is_folder
        self._overwrite = overwrite
        self._rows: list[IndexRow] = []
        self._index: Location | None = None
        if len(logs) > 1:
            self._index = output.place / "index.html"
            self._refuse_bad_target(self._index, None)

    def write(self, source: Location, progress: Progress | None = None) -> Page:
        """Measure a log and write its page.

        Args:
            source: one of the logs.
            progress: is told bytes done and in all.

        Raises:
            CallError: no such file, or the target may not be written.
            LogtoolError: the log cannot be used, or the page not be written.
        """
        target = self._targets[source]
        try:
            self._refuse_bad_target(target, source)
            measured = measure(source, self._options, progress)
            typical = default_window(measured.stats)
            measured = with_detail(source, self._options, measured, typical, progress)
            html = _page_of(source, measured)
            with self._whole_file(target) as file:
                file.write(html)
        except LogtoolError as error:
            self._rows.append(IndexRow(file_name(source), error=str(error)))
            raise
        self._rows.append(index_row(measured.stats, measured.facts, target.name))
        return Page(source, target, len(html), measured)

    def finish(self) -> None:
        """Write the index of several logs; one that has no page is in it with the reason."""
        if self._index is not None:
            with self._whole_file(self._index) as file:
                file.write(index(self._rows))

    def _refuse_bad_target(self, target: Location, source: Location | None) -> None:
        refuse_bad_target(
            target, source, overwrite=self._overwrite, makes_folder=self._makes_folder
        )

    def _whole_file(self, target: Location) -> AbstractContextManager[BinaryIO]:
        return whole_file(target, overwrite=self._overwrite, makes_folder=self._makes_folder)


def _page_of(source: Location, measured: Measurement) -> bytes:
    damage = [Place(loss.offset, loss.bytes, loss.what) for loss in measured.losses]
    size = 0 if is_folder(source) else version(source)[0]
    return page(measured.stats, measured.facts, damage, size)
