"""The result of `read`: a log as columns, as recorded."""

from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass

from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.recording import JointTable, VectorSamples
from dogbot_logtool.io.storage import Location
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.recording import read_recording
from dogbot_logtool.robot.measuring.plan import make_plan
from dogbot_logtool.robot.recorded import open_recorded


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """Columns of a log, each topic's in the order of its log times, which are ns.

    Nothing is corrected: forces have the sensors' offsets and are in the frames of their messages;
    those of raw sensors without a scale are counts.
    """

    feet: Mapping[str, Samples]
    """Contact samples by foot: `log_time`, `stamp`, `force` (n, 3) N, `in_contact`, `position`
    (n, 3) m ..."""
    base: Odometry
    """Poses of the base: `position` (n, 3) m, `orientation` (n, 4) x, y, z, w ..."""
    joints: tuple[JointTable, ...]
    """Joint states, the best topic first."""
    commands: VectorSamples | None
    """Velocity commands; None: the log has none. Likewise `accelerations` of the base."""
    accelerations: VectorSamples | None

    def __repr__(self) -> str:
        samples = sum(len(each.log_time) for each in self.feet.values())
        poses = len(self.base.log_time)
        return f"<Recording: {samples:,} contact samples of {len(self.feet)} feet, {poses:,} poses>"


def read_columns(path: Location, options: MeasureOptions) -> Recording:
    """Read what tells of base, feet and joints; see `Recording`.

    Raises:
        CallError: no such file, or a topic or time in the options that the log does not have.
        LogError: it is no log, or has nothing to measure.
    """
    with closing(open_recorded(path, options.joined)) as log:
        plan = make_plan(log, options)
        read = read_recording(log, plan.wanted, options.jobs).recording
    names = [foot.name for foot in plan.selection.robot.feet]
    sides = (read.commands, read.accelerations)
    commands, accelerations = (None if each is None else each.samples for each in sides)
    feet = dict(zip(names, read.feet, strict=True))
    return Recording(feet, read.base, read.joints, commands, accelerations)
