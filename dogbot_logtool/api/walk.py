"""The result of `measure`: figures, and tables of strides, stances, joints, events and more."""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.api.curves import POINTS, Curves, curves_of
from dogbot_logtool.api.keywords import PathOrName
from dogbot_logtool.api.table import Table, texts
from dogbot_logtool.commands.stats import measure_log
from dogbot_logtool.core.arrays import Floats, Ints, norms
from dogbot_logtool.core.checks.voids import void_columns, void_patterns
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.contact.stances import Cut
from dogbot_logtool.core.corrected import usable_samples
from dogbot_logtool.core.gait.feet import FIGURES, FootSteps
from dogbot_logtool.core.metrics import (
    Event,
    Finding,
    Foot,
    Forces,
    GaitOfLog,
    Joint,
    Legs,
    Quality,
    Stability,
    WalkMetrics,
)
from dogbot_logtool.core.records import fields_of
from dogbot_logtool.core.timespans import covers
from dogbot_logtool.core.walk import Walk as MeasuredWalk
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import Location, location
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.report.table_file import stride_table
from dogbot_logtool.results import Measurement
from dogbot_logtool.robot.annotated import open_recorded

if TYPE_CHECKING:
    from dogbot_logtool.options import MeasureOptions


@dataclass(frozen=True, eq=False, repr=False)
class Walk:
    """The measurement of a log. Times in tables count in s from `start_ns`."""

    path: Location
    _measured: Measurement
    _options: "MeasureOptions" = field(repr=False)

    def __repr__(self) -> str:
        gait = self.gait.name or "gait not known"
        return f"<Walk {self.metrics.log.path}: {gait}, {len(self.strides)} strides>"

    @property
    def start_ns(self) -> int:
        """ns, the earliest time of any used message: what times in tables count from."""
        return self._stats.origin

    @property
    def damaged(self) -> bool:
        """Whether some of the log could not be read; `stats["findings"]` says what."""
        return bool(self._measured.damage.losses)

    @property
    def metrics(self) -> WalkMetrics:
        """All metrics as records; docs/metrics.md defines each."""
        return self._measured.metrics

    @property
    def gait(self) -> GaitOfLog:
        """How the feet are coordinated: of the longest segment, and all `segments`."""
        return self.metrics.gait

    @property
    def feet(self) -> Mapping[str, Foot]:
        """Each foot's stances, strides and loads, by its name."""
        return self.metrics.feet

    @property
    def forces(self) -> Forces:
        """Loads of the whole robot."""
        return self.metrics.forces

    @property
    def stability(self) -> Stability:
        """Static stability."""
        return self.metrics.stability

    @property
    def legs(self) -> Legs:
        """Joints and their work."""
        return self.metrics.legs

    @property
    def quality(self) -> Quality:
        """Whether the recording can be trusted."""
        return self.metrics.quality

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What to know before relying on the metrics, the worst first."""
        return self.metrics.findings

    @cached_property
    def stats(self) -> dict[str, Any]:
        """All metrics as plain data: what `stats --json -v` prints."""
        return stats_json(self._measured)

    @cached_property
    def strides(self) -> Table:
        """Whole strides, foot by foot: the rows of `export --table strides`."""
        strides = stride_table(self._stats, void_patterns(self._measured.findings))
        return Table({"foot": texts(list(strides.foot)), **strides.columns})

    @cached_property
    def stances(self) -> Table:
        """All stances, foot by foot; `cut` says why one is no whole stance, and is else empty.

        What a cut stance shows is there as well: a figure over whole stances leaves it out.
        """
        feet = self._stats.feet
        rows = [foot.stances for foot in feet]
        names = [foot.name for foot in feet for _ in foot.stances.touchdown]
        cuts = [_CUTS[Cut(cut)] for each in rows for cut in each.cut.tolist()]
        columns: dict[str, NDArray[Any]] = {
            "foot": texts(list(names)),
            "touchdown_s": self._seconds(_joined([each.touchdown for each in rows])),
            "lift_off_s": self._seconds(_joined([each.liftoff for each in rows])),
            "cut": texts(list(cuts)),
        }
        void = void_patterns(self._measured.findings)
        known = [_stance_columns(foot, void) for foot in feet]
        for name in _COLUMNS:
            columns[name] = _joined([each[name] for each in known])
        return Table(columns)

    @cached_property
    def events(self) -> Table:
        """Events in the order of time: the columns of `export --table events`."""
        return _table(Event, self.metrics.events)

    @cached_property
    def joints(self) -> Table:
        """Joints, a row each: `legs.joints` without the curves; none where the log has none."""
        joints = self.legs.joints
        columns = _table(Joint, tuple(joints.values())).columns
        return Table({"joint": texts(list(joints)), **columns})

    @cached_property
    def base(self) -> Table:
        """Poses of the base in the world as recorded, up to 100 a second; yaw is unwrapped."""
        base = self._stats.base_history
        names = ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")
        values = np.column_stack([base.position, base.angles])
        columns = {name: values[:, row].copy() for row, name in enumerate(names)}
        return Table({"time_s": self._seconds(base.time), **columns})

    @cached_property
    def commands(self) -> Table:
        """Commanded and measured velocity, 50 times a second where both are known.

        In the base's own axes (yaw only), means over a stride; no rows in a log without commands.
        """
        track = self._stats.command_track
        parts = ("forward_mps", "lateral_mps", "yaw_radps")
        none = np.empty((0, 3))
        values = {
            "commanded": none if track is None else track.commanded,
            "measured": none if track is None else track.measured,
        }
        time = np.empty(0, np.int64) if track is None else track.time
        return Table(
            {
                "time_s": self._seconds(time),
                **{
                    f"{kind}_{part}": columns[:, row].copy()
                    for kind, columns in values.items()
                    for row, part in enumerate(parts)
                },
            }
        )

    def samples(self, foot: str) -> Table:
        """Read the log again and return every contact sample of a foot that was measured.

        Forces are those that figures are made of: on the foot, in N, sensor offsets taken off. The
        parts `force_x_n` ... are in the world, and NaN where that direction is not known, as are
        contact points without one. `state` is `stance`, `swing` or `unknown` (of a dead sensor, or
        where the clock was set).

        Raises:
            CallError: the robot has no such foot, or the log is gone.
            LogError: the log has become one that cannot be read.
        """
        if foot not in self.feet:
            raise CallError(f"{foot!r} is no foot of this robot; it has {listed(list(self.feet))}")
        number = list(self.feet).index(foot)
        return Table(self._sample_columns(number, self._samples()[number]))

    def curves(self, foot: str, points: int = POINTS) -> Curves:
        """Read the log again and return the forces of a foot over each of its whole strides.

        The samples of `samples` are interpolated linearly at equal parts of the stride; the rows
        are those of the foot in `strides`.

        Args:
            foot: its name.
            points: from 0 to 100 % of the stride, both counted.

        Raises:
            CallError: the robot has no such foot, fewer than 2 points are asked for, or the log is
                gone.
            LogError: the log has become one that cannot be read.
        """
        if points < _FEWEST_POINTS:
            raise CallError(f"points={points}: a curve has at least {_FEWEST_POINTS}")
        samples = self.samples(foot)
        strides = self._stats.feet[list(self.feet).index(foot)].strides
        return curves_of(foot, samples, self._seconds(strides.touchdown), strides.period_s, points)

    def plot(self, target: PathOrName, *, overwrite: bool = False) -> tuple[float, float]:
        """Draw gait diagram and load curves of some strides for a paper.

        Args:
            target: the file; it ends in .pdf, .svg or .png.
            overwrite: replace a file that is there.

        Returns:
            s, from and to: what is drawn.

        Raises:
            CallError: the file may not be written.
            LogtoolError: matplotlib is not installed, or there are no feet.
        """
        from dogbot_logtool.commands.plot import draw_figure, refuse_bad_figure  # noqa: PLC0415

        refuse_bad_figure(Path(target), [self.path], overwrite=overwrite)
        return draw_figure(self._measured, Path(target), overwrite=overwrite)

    def report(self, target: PathOrName, *, replay: bool = True, overwrite: bool = False) -> None:
        """Read the log again and write its page: what `dogbot-logtool report` does.

        Args:
            target: the HTML file.
            replay: show the walk in 3D, which takes up to a megabyte.
            overwrite: replace a page that is there.

        Raises:
            CallError: the page may not be written.
            LogtoolError: it cannot be written, or the extra `report` is not installed.
        """
        from dogbot_logtool.report.page import require_libraries  # noqa: PLC0415

        require_libraries()
        from dogbot_logtool.commands.report import Reports  # noqa: PLC0415
        from dogbot_logtool.io.targets import Output  # noqa: PLC0415

        page = Output(location(os.fspath(target)), is_folder=False)
        Reports([self.path], page, self._options, overwrite=overwrite, with_replay=replay).write(
            self.path
        )

    def all_samples(self) -> Iterator[Table]:
        """Read the log again and yield the samples of each foot.

        The columns are those of `samples`, behind the name of the foot; rows are in the order of
        time.

        Raises:
            CallError: the log is gone.
            LogError: it has become one that cannot be read.
        """
        for number, samples in enumerate(self._samples()):
            names = texts([list(self.feet)[number]] * len(samples.foot))
            yield Table({"foot": names, **self._sample_columns(number, samples)})

    def _samples(self) -> tuple[Samples, ...]:
        """Read the contact samples of each foot, as they were measured."""
        log = open_recorded(self.path, self._options.joined)
        try:
            walk = measure_log(log, self._options).measurement.walk
        finally:
            log.close()
        return usable_samples(walk.recording, walk.settings)

    def _sample_columns(self, foot: int, samples: Samples) -> dict[str, NDArray[Any]]:
        """Return the columns of some samples of a foot."""
        settings = self._stats.settings
        time, force = settings.clock.of(samples), samples.force.astype(np.float64)
        # No force is none in every frame.
        in_world = samples.in_world | settings.force_in_world | ~samples.force.any(axis=1)
        return {
            "time_s": self._seconds(time),
            "state": self._states(foot, time),
            "in_contact": samples.in_contact.copy(),
            "force_n": norms(force),
            **_parts("force_{}_n", np.where(in_world[:, None], force, np.nan)),
            **_parts("point_{}_m", samples.position),
        }

    @property
    def _stats(self) -> MeasuredWalk:
        return self._measured.walk

    def _seconds(self, time: Ints) -> Floats:
        """Return times as seconds since the start, (n,)."""
        return (time - self.start_ns) / 1e9

    def _states(self, foot: int, time: Ints) -> NDArray[np.object_]:
        """Return what a foot does at some times, (n,)."""
        figures = self._stats.feet[foot]
        record = figures.record
        states = np.full(len(time), "unknown", np.object_)
        if figures.is_dead:
            return states
        ends = np.isin(time, record.known[:, 1])
        states[covers(record.known, time) | ends] = "swing"
        # A stance ends before the sample of lift-off, but with the last one that is known.
        cut = ends & np.isin(time, record.in_contact[:, 1]) & ~np.isin(time, figures.liftoff)
        states[covers(record.in_contact, time) | cut] = "stance"
        return states


def _stance_columns(foot: FootSteps, void: Sequence[str]) -> Mapping[str, Floats]:
    """Return metrics of a foot's stances, (k,) by name; NaN where not known or void."""
    figures = foot.stances.figures
    columns = {name: getattr(figures, name) for name in _COLUMNS}
    return void_columns(columns, foot.name, void)


_FEWEST_POINTS = 2
_CUTS = {
    Cut.WHOLE: "",
    Cut.LOG_START: "log_start",
    Cut.LOG_END: "log_end",
    Cut.GAP: "gap",
    Cut.STANDING: "standing",
    Cut.FALL: "fall",
}


_COLUMNS = (*FIGURES[:4], "vertical_impulse_ns", *FIGURES[4:])
"""Columns of `Walk.stances` that are figures of `StanceFigures`."""


def _numbers(values: list[Any]) -> Floats:
    """Return numbers, (n,); NaN for null."""
    return np.array([np.nan if each is None else each for each in values], np.float64)


def _table(record: type, rows: Sequence[Any]) -> Table:
    """Return records as a table: their texts and numbers."""
    columns: dict[str, NDArray[Any]] = {}
    for each in fields_of(record):
        if each.kind == "scalar":
            values = [getattr(row, each.name) for row in rows]
            columns[each.name] = texts(values) if each.inner is str else _numbers(values)
    return Table(columns)


def _joined(parts: list[Any]) -> NDArray[Any]:
    """Return the parts of a column as one; (n,)."""
    return np.concatenate([np.empty(0, parts[0].dtype if parts else np.float64), *parts])


def _parts(name: str, vectors: Floats) -> dict[str, Floats]:
    """Return the parts of vectors, (n, 3), as columns."""
    return {name.format(axis): vectors[:, row].copy() for row, axis in enumerate("xyz")}
