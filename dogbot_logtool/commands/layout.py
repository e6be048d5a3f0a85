"""`dogbot-logtool layout`: the view of an annotated walk, set up for a viewer."""

from pathlib import Path

from dogbot_logtool.pipeline.annotated import open_recorded
from dogbot_logtool.pipeline.feet.selection import assign_feet
from dogbot_logtool.pipeline.options import ConvertOptions, TopicOptions
from dogbot_logtool.pipeline.plan import make_plan
from dogbot_logtool.pipeline.probe import DEFAULT_BASE, DEFAULT_WORLD, probe_log
from dogbot_logtool.pipeline.selection import select_topics
from dogbot_logtool.report.layouts.view import View
from dogbot_logtool.robot import Robot, load_robot


def view_of(log: Path | None, options: TopicOptions) -> View:
    """Return what is shown of a log, or of any log of a robot.

    Raises:
        CallError: no such robot, log or topic.
        LogError: the log cannot be read.
    """
    if log is None:
        robot = load_robot(options.robot or "dogbot")
        topics, guessed = options.foot_topics or {}, options.robot is None
        robot = assign_feet(robot, topics, frozenset(), guessed=guessed)
        return _view(robot, robot.world_frame or DEFAULT_WORLD, robot.base_frame or DEFAULT_BASE)
    opened = open_recorded(log)
    try:
        selection = select_topics(opened, options)
        plan = make_plan(opened, selection, probe_log(opened, selection), ConvertOptions())
        return _view(selection.robot, plan.world_frame, plan.base_frame)
    finally:
        opened.close()


def _view(robot: Robot, world: str, base: str) -> View:
    return View(tuple(foot.name for foot in robot.feet), world, base, robot.forward_axis)
