"""`dogbot-logtool robots new`: a robot's file from a log, with the evidence for each line."""

from contextlib import closing
from dataclasses import replace
from typing import NamedTuple

from dogbot_logtool.commands.stats import measure_log
from dogbot_logtool.errors import LogError
from dogbot_logtool.io.storage import Location, file_name
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.loss import Damage
from dogbot_logtool.report.robot_file import RobotEvidence, robot_file
from dogbot_logtool.robot.names import FootSet
from dogbot_logtool.robot.recorded import open_recorded
from dogbot_logtool.robot.selection import select_topics
from dogbot_logtool.robot.topics import nothing_to_do
from dogbot_logtool.run.runner import OnProgress


class NewRobot(NamedTuple):
    """A robot's file."""

    text: str
    runners_up: tuple[FootSet, ...]
    """Other fields that may be the feet."""
    damage: Damage


def new_robot(
    path: Location, name: str, options: MeasureOptions, progress: OnProgress | None = None
) -> NewRobot:
    """Describe the robot of a log.

    Args:
        path: the log.
        name: what to call the robot.
        options: what the user says of it.
        progress: called with bytes done and bytes in all.

    Raises:
        CallError: no such file, or an option that does not fit it.
        LogError: it is no log, or has nothing that may be feet or a base.
    """
    with closing(open_recorded(path, options.joined)) as log:
        selection = select_topics(log, options)
        others = [*selection.possible_feet]
        because = ["Found by the types and names of their topics."]
        if others:
            chosen = others.pop(0)
            because = [f"Chosen since: {'; '.join(chosen.reasons)}."]
            options = replace(options, feet=chosen.feet)
            selection = select_topics(log, options)
        if not selection.odometry and not selection.contacts:
            raise LogError(nothing_to_do(log, selection.findings))
        found = measure_log(log, options, progress)
    named, measured = selection.robot.feet, found.measurement
    walk = measured.walk
    evidence = RobotEvidence(
        log=file_name(path),
        world_frame=walk.frames.world,
        base_frame=walk.frames.base,
        has_base=bool(found.selection.odometry),
        feet_because=because,
        weight_n=walk.settings.estimated_weight_n,
        damage=measured.damage.text,
        metrics=measured.metrics,
    )
    # The sensors of a foot are named one by one.
    robot = replace(
        found.selection.robot,
        name=name,
        description=f"{name}, from a log",
        odometry_topic=found.selection.base_name,
        feet=named if any(foot.sensor_of for foot in named) else found.selection.robot.feet,
    )
    return NewRobot(robot_file(robot, evidence), tuple(others), measured.damage)
