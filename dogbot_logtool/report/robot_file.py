"""A robot's file, written from a log: each line with its evidence as a comment.

What a log without the file would be measured with stands as it is; what is only estimated stands
as a comment, for a person to check.
"""

import textwrap
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.io.printable import printable
from dogbot_logtool.io.toml_table import to_toml, toml_values
from dogbot_logtool.reader.foot import Foot
from dogbot_logtool.robot.robot import Robot

_WIDTH: Final = 100
_GRAVITY: Final = 9.81


class RobotEvidence(NamedTuple):
    """Evidence of a robot in a log."""

    log: str
    """Its name."""
    world_frame: str
    base_frame: str
    has_base: bool
    """Whether the log has the base's poses, so that frames and the forward axis mean something."""
    feet_because: Sequence[str]
    """Sentences on why these are the feet."""
    weight_n: float | None
    """N, the feet's mean sum of loads, where no mass is known."""
    damage: str
    """What could not be read of the log; empty if it is sound."""
    metrics: WalkMetrics
    """Metrics of the log."""


def robot_file(robot: Robot, evidence: RobotEvidence) -> str:
    """Return the robot's file, ready to be read by `load_robot`."""
    if evidence.has_base:
        robot = replace(robot, world_frame=evidence.world_frame, base_frame=evidence.base_frame)
    values = toml_values(robot)
    values["forward_axis"] = to_toml(evidence.metrics.settings.forward_axis)
    remarks = {"mass_kg": _weight(robot, evidence), "forward_axis": _speeds(evidence)}
    lines = [
        *_comment(f"Written by 'dogbot-logtool robots new' from {evidence.log}; check it."),
        *_comment(f"The log is damaged: {evidence.damage}" if evidence.damage else ""),
    ]
    for key in dict.fromkeys(["name", "description", *remarks, *values]):
        if "." not in key:
            lines += remarks.get(key, [])
            lines += [f"{key} = {values[key]}"] if key in values else []
    for section in ("topics", "frames", "arrows", "contact"):
        own = {key: text for key, text in values.items() if key.startswith(f"{section}.")}
        lines += ["", f"[{section}]"] if own or section == "contact" else []
        lines += [f"{key.partition('.')[2]} = {text}" for key, text in own.items()]
    lines += _used_thresholds(values.keys(), evidence)
    if robot.feet:
        lines += ["", *_comment("Reference foot first. " + " ".join(evidence.feet_because))]
    for foot in robot.feet:
        lines += ["", *_foot(foot, evidence.metrics)]
    return "\n".join(lines) + "\n"


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(printable(text), _WIDTH - 2)]


def _weight(robot: Robot, evidence: RobotEvidence) -> list[str]:
    """Return what the loads tell of a mass that is not known."""
    if robot.mass_kg is not None:
        return []
    if evidence.weight_n is None:
        return ["# mass_kg =              # not known: the log does not tell forces"]
    text = (
        f"The feet's loads add up to {evidence.weight_n:.4g} N on average. That is the weight "
        "if the sensors read newtons; weigh the robot."
    )
    return [*_comment(text), f"# mass_kg = {evidence.weight_n / _GRAVITY:.3g}"]


def _speeds(evidence: RobotEvidence) -> list[str]:
    """Return why the forward axis is what it is."""
    base = evidence.metrics.base
    forward, left = base.forward_speed_mps, base.lateral_speed_mps
    if forward is None or left is None:
        return _comment("Forward axis: REP-103; the log does not show the base moving.")
    speeds = f"{forward:.3g} m/s along it and {left:.3g} m/s to its left"
    return _comment(f"Forward axis: the base moves at {speeds}.")


def _used_thresholds(given: Collection[str], evidence: RobotEvidence) -> Iterator[str]:
    """Yield the thresholds that are not given but used for this log, as comments."""
    yield from _comment("Unset thresholds follow the weight and the sensors' noise.")
    feet = evidence.metrics.settings.feet.values()
    for key, used in (
        ("on_n", {each.contact_on_n for each in feet}),
        ("off_n", {each.contact_off_n for each in feet}),
        ("debounce_s", {each.debounce_s for each in feet}),
    ):
        if f"contact.{key}" not in given and len(used) == 1 and (value := used.pop()) is not None:
            yield f"# {key} = {value:.4g}  # used for this log"


def _foot(foot: Foot, metrics: WalkMetrics) -> Iterator[str]:
    if not foot.topic:
        yield from (f"# [feet.{foot.name}]", "# topic =                # the log has none")
        return
    yield f"[feet.{foot.name if foot.name.isascii() else to_toml(foot.name)}]"
    yield from _comment(_seen(foot, metrics))
    values = {**toml_values(foot), **(toml_values(foot.field) if foot.field else {})}
    yield from (f"{key} = {text}" for key, text in values.items())
    if foot.leg_position is None:
        yield '# place = ["front", "left"]  # not known; gaits are named by it'
    estimated = None if foot.sensor_of else metrics.quality.feet[foot.name].force_offset_n
    if foot.offset_n is None and estimated and any(estimated):
        rounded = ", ".join(f"{each:.4g}" for each in estimated)
        yield f"# offset_n = [{rounded}]  # estimated from this log, as from any other"


def _seen(foot: Foot, metrics: WalkMetrics) -> str:
    whole = metrics.feet[foot.sensor_of or foot.name]
    topic = metrics.quality.topics.get(foot.topic)
    parts = ["no messages"] if topic is None else [f"{topic.messages:,} messages"]
    if topic is not None and topic.rate_hz:
        parts.append(f"{topic.rate_hz:.3g} a second")
    if whole.contact_fraction is not None:
        parts.append(f"in contact {whole.contact_fraction:.0%} of the time")
    parts.append(f"{whole.strides or 0} strides")
    return ", ".join(parts)
