"""A robot's file, written from a log: each line with its evidence as a comment.

What a log without the file would be measured with stands as it is; what is only estimated stands
as a comment, for a person to check.
"""

import json
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.dataclass import dataclass
from dogbot_logtool.io.printable import printable
from dogbot_logtool.reader.foot import Foot, FootField
from dogbot_logtool.robot.robot import NEWTONS, Robot

_WIDTH: Final = 100
_GRAVITY: Final = 9.81


@dataclass(frozen=True, slots=True)
class RobotEvidence:
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
    lines = [
        *_comment(f"Written by 'dogbot-logtool robots new' from {evidence.log}; check it."),
        *_comment(f"The log is damaged: {evidence.damage}" if evidence.damage else ""),
        f"name = {_text(robot.name)}",
        f"description = {_text(robot.description)}",
        *_mass(robot, evidence),
        *_forward_axis(evidence),
    ]
    if robot.com_offset_m is not None:
        lines.append(f"com_offset_m = [{', '.join(map(_number, robot.com_offset_m))}]")
    if robot.foot_rolling_m is not None:
        lines.append(f"foot_rolling_m = {_number(robot.foot_rolling_m)}")
    if robot.odometry_topic is not None:
        lines += ["", "[topics]", f"odometry = {_text(robot.odometry_topic)}"]
    if evidence.has_base:
        lines += ["", *_comment("Frames as the messages with the base's poses name them.")]
        lines += ["[frames]", f"world = {_text(evidence.world_frame)}"]
        lines.append(f"base = {_text(evidence.base_frame)}")
    lines += ["", "[arrows]"]
    if robot.newtons_per_metre is not None:
        lines.append(f"newtons_per_metre = {_number(robot.newtons_per_metre)}")
    lines.append(f"shaft_diameter_m = {_number(robot.shaft_diameter_m)}")
    lines += ["", *_contact(robot, evidence)]
    if robot.feet:
        lines += ["", *_comment("Reference foot first. " + " ".join(evidence.feet_because))]
    for foot in robot.feet:
        if not foot.topic:
            lines += ["", f"# [feet.{foot.name}]", "# topic =                # the log has none"]
            continue
        lines += ["", *_foot(foot, evidence.metrics)]
    return "\n".join(lines) + "\n"


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(printable(text), _WIDTH - 2)]


def _text(value: str) -> str:
    # TOML's basic strings are JSON's, but for one more character that must be escaped.
    return json.dumps(value).replace("\x7f", "\\u007f")


def _number(value: float) -> str:
    return repr(float(value))


def _numbers(values: Sequence[float]) -> str:
    return f"[{', '.join(map(_number, values))}]"


def _mass(robot: Robot, evidence: RobotEvidence) -> list[str]:
    if robot.mass_kg is not None:
        return [f"mass_kg = {_number(robot.mass_kg)}"]
    if evidence.weight_n is None:
        return ["# mass_kg =              # not known: the log does not tell forces"]
    kilograms = evidence.weight_n / _GRAVITY
    return [
        *_comment(
            f"The feet's loads add up to {evidence.weight_n:.4g} N on average. That is the weight "
            "if the sensors read newtons; weigh the robot."
        ),
        f"# mass_kg = {kilograms:.3g}",
    ]


def _forward_axis(evidence: RobotEvidence) -> list[str]:
    axis, base = evidence.metrics.settings.forward_axis, evidence.metrics.base
    forward, left = base.forward_speed_mps, base.lateral_speed_mps
    if forward is None or left is None:
        because = "REP-103; the log does not show the base moving"
    else:
        because = f"the base moves at {forward:.3g} m/s along it and {left:.3g} m/s to its left"
    return [*_comment(f"Forward axis: {because}."), f"forward_axis = {_text(axis)}"]


def _contact(robot: Robot, evidence: RobotEvidence) -> Iterator[str]:
    yield "[contact]"
    given = {
        "on_n": robot.contact_on_n,
        "off_n": robot.contact_off_n,
        "on_counts": robot.contact_on_counts,
        "debounce_s": robot.debounce_s,
    }
    feet = evidence.metrics.settings.feet.values()
    used = {
        "on_n": _of_all(each.contact_on_n for each in feet),
        "off_n": _of_all(each.contact_off_n for each in feet),
        "debounce_s": _of_all(each.debounce_s for each in feet),
    }
    yield from _comment("Unset thresholds follow the weight and the sensors' noise.")
    for key, value in given.items():
        if value is not None:
            yield f"{key} = {_number(value)}"
        elif (own := used.get(key)) is not None:
            yield f"# {key} = {own:.4g}  # used for this log"


def _of_all(values: Iterable[float | None]) -> float | None:
    """Return what is the same of all feet; None where they differ."""
    found = set(values)
    return found.pop() if len(found) == 1 else None


def _foot(foot: Foot, metrics: WalkMetrics) -> Iterator[str]:
    yield f"[feet.{foot.name if foot.name.isascii() else _text(foot.name)}]"
    yield from _comment(_seen(foot, metrics))
    yield f"topic = {_text(foot.topic)}"
    if foot.field is not None:
        yield from _field(foot.field)
    if foot.collision:
        yield f"collision = {_text(foot.collision)}"
    if foot.leg_position is not None:
        yield f"place = [{_text(foot.leg_position[0])}, {_text(foot.leg_position[1])}]"
    else:
        yield '# place = ["front", "left"]  # not known; gaits are named by it'
    yield from _foot_sensor(foot, metrics.quality.feet[foot.name].force_offset_n)


def _foot_sensor(foot: Foot, estimated: Sequence[float] | None) -> Iterator[str]:
    """Yield where a foot's sensor is and how it reads."""
    if foot.frame is not None:
        yield f"frame = {_text(foot.frame)}"
    if any(foot.contact_point_m):
        yield f"contact_point_m = {_numbers(foot.contact_point_m)}"
    if foot.element is not None:
        yield f"element = {foot.element}"
    if foot.label:
        yield f"label = {_text(foot.label)}"
    if foot.offset:
        yield f"offset = {_number(foot.offset)}"
    if foot.newtons_per_count is not None:
        yield f"newtons_per_count = {_number(foot.newtons_per_count)}"
    if foot.offset_n is not None:
        yield f"offset_n = {_numbers(foot.offset_n)}"
    elif estimated and any(estimated):
        rounded = ", ".join(f"{each:.4g}" for each in estimated)
        yield f"# offset_n = [{rounded}]  # estimated from this log, as from any other"


def _seen(foot: Foot, metrics: WalkMetrics) -> str:
    found, topic = metrics.feet[foot.name], metrics.quality.topics.get(foot.topic)
    parts = ["no messages"] if topic is None else [f"{topic.messages:,} messages"]
    if topic is not None and topic.rate_hz:
        parts.append(f"{topic.rate_hz:.3g} a second")
    if found.contact_fraction is not None:
        parts.append(f"in contact {found.contact_fraction:.0%} of the time")
    parts.append(f"{found.strides or 0} strides")
    return ", ".join(parts)


def _field(field: FootField) -> Iterator[str]:
    yield f"field = {_text(field.path)}"
    if field.kind:
        yield f"kind = {_text(field.kind)}"
    if field.scale != 1.0:
        yield f"scale = {_number(field.scale)}"
    if field.newtons_per_unit != 1.0:
        unit = next(name for name, value in NEWTONS.items() if value == field.newtons_per_unit)
        yield f"unit = {_text(unit)}"
    if field.sign < 0:
        yield 'sign = "-"'
    if field.axis:
        yield f"axis = {_text(field.axis)}"
    if field.threshold:
        yield f"threshold = {_number(field.threshold)}"
