"""The result of `measure`: metrics, and tables of strides, stances, joints, events and more."""

import os
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.api.keywords import PathOrName
from dogbot_logtool.api.table import Table
from dogbot_logtool.commands.stats import measure_log
from dogbot_logtool.core.arrays import Floats, Ints, norms
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.corrected import usable_samples
from dogbot_logtool.core.events import with_steps
from dogbot_logtool.core.metrics import Event, Joint
from dogbot_logtool.core.records import fields_of
from dogbot_logtool.core.timespans import covers
from dogbot_logtool.errors import CallError
from dogbot_logtool.io.printable import listed
from dogbot_logtool.io.storage import Location, location
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.report.tables import stance_columns, stride_table
from dogbot_logtool.results import Measurement
from dogbot_logtool.robot.recorded import open_recorded

if TYPE_CHECKING:
    from dogbot_logtool.options import MeasureOptions


class Walk:
    """The measurement of a log. Times in tables count in s from `start_ns`."""

    def __init__(self, path: Location, measured: Measurement, options: "MeasureOptions") -> None:
        self._measured: Final = measured
        self._walk: Final = measured.walk
        self._options: Final = options
        metrics = measured.metrics
        self.path: Final = path
        self.start_ns: Final = measured.walk.origin
        """ns, the earliest time of any used message: what times in tables count from."""
        self.damaged: Final = bool(measured.damage.losses)
        """Whether some of the log could not be read; `stats["findings"]` says what."""
        self.metrics: Final = metrics
        """All metrics as records; docs/metrics.md defines each."""
        self.gait: Final = metrics.gait
        """How the feet are coordinated: of the longest segment, and all `segments`."""
        self.feet: Final = metrics.feet
        """Each foot's stances, strides and loads, by its name."""
        self.forces: Final = metrics.forces
        """Loads of the whole robot."""
        self.stability: Final = metrics.stability
        """Static stability."""
        self.legs: Final = metrics.legs
        """Joints and their work."""
        self.quality: Final = metrics.quality
        """Whether the recording can be trusted."""
        self.findings: Final = metrics.findings
        """What to know before relying on the metrics, the worst first."""

    def __repr__(self) -> str:
        gait = self.gait.name or "gait not known"
        return f"<Walk {self.metrics.log.path}: {gait}, {len(self.strides)} strides>"

    @cached_property
    def stats(self) -> dict[str, Any]:
        """All metrics as plain data: what `stats --json -v` prints."""
        return stats_json(self._measured)

    @cached_property
    def strides(self) -> Table:
        """Whole strides, foot by foot: the rows of `export --table strides`."""
        strides = stride_table(self._walk)
        return Table({"foot": np.array(strides.foot, np.object_), **strides.columns})

    @cached_property
    def stances(self) -> Table:
        """All stances, foot by foot; `cut` says why one is no whole stance, and is else empty.

        What a cut stance shows is there as well: a metric of whole stances leaves it out.
        """
        return Table(stance_columns(self._walk))

    @cached_property
    def events(self) -> Table:
        """Events in the order of time: the columns of `export --table events`."""
        return _table(Event, with_steps(self.metrics))

    @cached_property
    def joints(self) -> Table:
        """Joints, a row each: `legs.joints` without the curves; none where the log has none."""
        joints = self.legs.joints
        columns = _table(Joint, tuple(joints.values())).columns
        return Table({"joint": np.array(list(joints), np.object_), **columns})

    @cached_property
    def base(self) -> Table:
        """Poses of the base in the world as recorded, up to 100 a second; yaw is unwrapped."""
        base = self._walk.base_history
        names = ("x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")
        parts = _parts(names, np.column_stack([base.position, base.angles]))
        return Table({"time_s": self._seconds(base.time), **parts})

    @cached_property
    def commands(self) -> Table:
        """Commanded and measured velocity, 50 times a second where both are known.

        In the base's own axes (yaw only), means over a stride; no rows in a log without commands.
        """
        track = self._walk.command_track
        time, values = np.empty(0, np.int64), np.empty((0, 6))
        if track is not None:
            time, values = track.time, np.column_stack([track.commanded, track.measured])
        parts = ("forward_mps", "lateral_mps", "yaw_radps")
        names = [f"{kind}_{part}" for kind in ("commanded", "measured") for part in parts]
        return Table({"time_s": self._seconds(time), **_parts(names, values)})

    def samples(self, foot: str) -> Table:
        """Read the log again and return every contact sample of a foot that was measured.

        Forces are those that metrics are made of: on the foot, in N, sensor offsets taken off. The
        parts `force_x_n` ... are in the world, and NaN where that direction is not known, as are
        contact points without one. `state` is `stance`, `swing` or `unknown` (of a dead sensor, or
        where the clock was set).

        Raises:
            CallError: the robot has no such foot, or the log is gone.
            LogError: the log has become one that cannot be read.
        """
        number = self._number(foot)
        return Table(self._sample_columns(number, self._samples()[number]))

    def curves(self, foot: str, points: int = 101) -> dict[str, Floats]:
        """Read the log again and return the forces of a foot over each of its whole strides.

        The samples of `samples` are interpolated linearly at equal parts of the stride.

        Args:
            foot: its name.
            points: from 0 to 100 % of the stride, both counted.

        Returns:
            "percent", (p,) of the stride; "start_s", (n,) touchdowns of the strides, as in
            `strides`; "force_n", "force_x_n" ... (n, p), NaN where not known.

        Raises:
            CallError: the robot has no such foot, or the log is gone.
            LogError: the log has become one that cannot be read.
        """
        strides = self._walk.feet[self._number(foot)].strides
        start_s = self._seconds(strides.touchdown)
        phase = np.linspace(0.0, 1.0, points)
        time = start_s[:, None] + strides.period_s[:, None] * phase
        samples = self.samples(foot)
        # Samples that repeat a time or step back belong to no metric, either.
        latest = np.maximum.accumulate(samples["time_s"])
        forward = np.diff(latest, prepend=-np.inf) > 0.0
        known = samples["time_s"][forward]
        values = {
            n: np.interp(time, known, samples[n][forward]) if len(time) else time for n in _FORCES
        }
        return {"percent": 100.0 * phase, "start_s": start_s, **values}

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
        from dogbot_logtool.io.output import Output  # noqa: PLC0415
        from dogbot_logtool.option import part_of  # noqa: PLC0415
        from dogbot_logtool.options.report import Report  # noqa: PLC0415

        page = Output(location(os.fspath(target)), is_folder=False)
        options = replace(part_of(self._options, Report), replay=replay)
        Reports([self.path], page, overwrite=overwrite).write(self.path, options)

    def all_samples(self) -> Iterator[Table]:
        """Read the log again and yield the samples of each foot.

        The columns are those of `samples`, behind the name of the foot; rows are in the order of
        time.

        Raises:
            CallError: the log is gone.
            LogError: it has become one that cannot be read.
        """
        for number, (name, samples) in enumerate(zip(self.feet, self._samples(), strict=True)):
            names = np.full(len(samples.foot), name, np.object_)
            yield Table({"foot": names, **self._sample_columns(number, samples)})

    def _number(self, foot: str) -> int:
        """Return the index of a foot.

        Raises:
            CallError: the robot has no such foot.
        """
        feet = list(self.feet)
        if foot not in feet:
            raise CallError(f"{foot!r} is no foot of this robot; it has {listed(feet)}")
        return feet.index(foot)

    def _samples(self) -> tuple[Samples, ...]:
        """Read the contact samples of each foot, as they were measured."""
        with closing(open_recorded(self.path, self._options.joined)) as log:
            walk = measure_log(log, self._options).measurement.walk
        return usable_samples(walk.recording, walk.settings)

    def _sample_columns(self, foot: int, samples: Samples) -> dict[str, NDArray[Any]]:
        """Return the columns of some samples of a foot."""
        settings = self._walk.settings
        time, force = settings.clock.of(samples), samples.force.astype(np.float64)
        # No force is none in every frame.
        in_world = samples.in_world | settings.force_in_world | ~samples.force.any(axis=1)
        force_in_world = np.where(in_world[:, None], force, np.nan)
        return {
            "time_s": self._seconds(time),
            "state": self._states(foot, time),
            "in_contact": samples.in_contact.copy(),
            "force_n": norms(force),
            **_parts(_FORCES[1:], force_in_world),
            **_parts(("point_x_m", "point_y_m", "point_z_m"), samples.position),
        }

    def _seconds(self, time: Ints) -> Floats:
        """Return times as seconds since the start, (n,)."""
        return (time - self.start_ns) / 1e9

    def _states(self, foot: int, time: Ints) -> NDArray[np.object_]:
        """Return what a foot does at some times, (n,)."""
        steps = self._walk.feet[foot]
        record = steps.record
        states = np.full(len(time), "unknown", np.object_)
        if steps.is_dead:
            return states
        ends = np.isin(time, record.known[:, 1])
        states[covers(record.known, time) | ends] = "swing"
        # A stance ends before the sample of lift-off, but with the last one that is known.
        cut = ends & np.isin(time, record.in_contact[:, 1]) & ~np.isin(time, steps.liftoff)
        states[covers(record.in_contact, time) | cut] = "stance"
        return states


_FORCES = ("force_n", "force_x_n", "force_y_n", "force_z_n")


def _table(record: type, rows: Sequence[Any]) -> Table:
    """Return records as a table: their texts and numbers."""
    columns: dict[str, NDArray[Any]] = {}
    for each in fields_of(record):
        if each.kind == "scalar":
            values = [getattr(row, each.name) for row in rows]
            # None is NaN in a column of numbers.
            columns[each.name] = np.array(values, np.object_ if each.inner is str else np.float64)
    return Table(columns)


def _parts(names: Sequence[str], vectors: Floats) -> dict[str, Floats]:
    """Return the parts of vectors, (n, p), as columns."""
    return dict(zip(names, np.ascontiguousarray(vectors.T), strict=True))
