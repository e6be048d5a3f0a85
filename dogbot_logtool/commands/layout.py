"""`dogbot-logtool layout`: the view of an annotated walk, set up for a viewer."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import fields
from math import degrees
from pathlib import Path
from typing import Final

import numpy as np

from dogbot_logtool.commands.stats import measure_log
from dogbot_logtool.core.arrays import norms
from dogbot_logtool.core.checks.recorded import zero_stamps
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.known_frames import DEFAULT_BASE, DEFAULT_WORLD
from dogbot_logtool.core.recording import LARGEST
from dogbot_logtool.core.settings import GRAVITY_MPS2
from dogbot_logtool.options import MeasureOptions, RobotOptions
from dogbot_logtool.reader.containers.log import damage_of
from dogbot_logtool.report.layouts import View, upper_bound
from dogbot_logtool.robot.description import body_size_m, robot_shape
from dogbot_logtool.robot.feet import assign_feet
from dogbot_logtool.robot.recorded import open_recorded
from dogbot_logtool.robot.robot import Robot, load_robot, with_settings

_NEARLY_ALL: Final = 0.995
"""Share of the loads that lie within the curves' bounds: a spike shall not flatten the rest."""
_ROOM: Final = 1.1
"""Bound over the load."""


def view_of(log: Path | None, options: RobotOptions) -> View:
    """Return what is shown of a log, or of any log of a robot.

    Raises:
        CallError: no such robot, log or topic.
        LogError: the log cannot be read, or has nothing that is shown.
    """
    if log is None:
        robot = load_robot(options.robot or "dogbot")
        topics, guessed = options.foot or {}, options.robot is None
        robot = assign_feet(robot, topics, frozenset(), guessed=guessed)
        robot = with_settings(robot, options)
        return _view(robot, robot.world_frame or DEFAULT_WORLD, robot.base_frame or DEFAULT_BASE)
    with closing(open_recorded(log)) as opened:
        given = {each.name: getattr(options, each.name) for each in fields(RobotOptions)}
        measured = measure_log(opened, MeasureOptions(**given))
        walk, selection = measured.measurement.walk, measured.selection
        recording, settings, frames = walk.recording, walk.settings, walk.frames
        view = _view(selection.robot, frames.world, frames.base)
        shape = robot_shape(walk)
        return view._replace(
            peak_n=_peak_n(recording.feet) or view.peak_n,
            forward_axis=settings.forward_axis,
            size_m=shape.size_m,
            turned_deg=degrees(walk.base_history.angles[:1, 2].sum()),
            has_stamps=not zero_stamps(recording, settings),
            damage=damage_of(opened, opened.losses),
        )


def _view(robot: Robot, world: str, base: str) -> View:
    return View(
        tuple(foot.name for foot in robot.feet),
        world,
        base,
        robot.forward_axis,
        None if robot.mass_kg is None else upper_bound(robot.mass_kg * GRAVITY_MPS2),
        body_size_m(robot.mass_kg)[0],
    )


def _peak_n(feet: Sequence[Samples]) -> float | None:
    """Return a round bound, N, of the loads that were seen, above their sensors' offsets."""
    largest = 0.0
    for samples in feet:
        force = norms(samples.force)
        force = force[np.isfinite(force) & (force < LARGEST)]
        if len(force):
            largest = max(largest, _ROOM * float(np.quantile(force, _NEARLY_ALL)))
    return upper_bound(largest) if largest > 0.0 else None
