"""What should be said beside the figures: why one is missing, and what makes one doubtful."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from dogbot_logtool.core.base.base_motion import BaseMotion
from dogbot_logtool.core.gait.foot_statistics import FootFigures
from dogbot_logtool.core.gait.gait import CONSISTENT, IRREGULAR, QUADRUPED
from dogbot_logtool.core.geometry import timespans
from dogbot_logtool.core.geometry.arrays import norms
from dogbot_logtool.core.load.load_figures import is_saturated, is_stuck, vertical_is_known
from dogbot_logtool.core.quality.quality import TopicQuality
from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding, Severity

WEIGHT_TOLERANCE: Final = 0.05
"""By how much the vertical impulse may miss the weight before that is said."""
SOME_S: Final = 0.1
"""s, time from which a lack is worth a warning."""
WALKED_M: Final = 0.5
"""m, way to a side from which its direction means something."""


def remarks(stats: Stats) -> tuple[Finding, ...]:
    """Return everything that should be said, warnings first."""
    found = [
        *_clock(stats),
        *_falls(stats),
        *(remark for foot in stats.feet for remark in _foot(stats, foot)),
        *_base(stats),
        *_gait(stats),
        *_loads(stats),
        *_stability(stats),
        *(remark for topic in stats.topics for remark in _topic(topic)),
    ]
    return tuple(sorted(found, key=lambda finding: finding.severity is Severity.NOTE))


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def _clock(stats: Stats) -> Iterator[Finding]:
    settings = stats.settings
    if settings.time_source_reason:
        text = f"{settings.time_source_reason}: everything is measured on log time"
        yield Finding("W_LOG_TIME_USED", text, "settings.time_source")


def _falls(stats: Stats) -> Iterator[Finding]:
    if len(stats.fallen):
        at = stats.seconds(stats.fallen[:, 0])[0]
        lies = timespans.total(stats.fallen) / 1e9
        text = (
            f"the robot falls at {at:.2f} s and lies for {lies:.1f} s in all; "
            "steps in that time are left out"
        )
        yield Finding("W_FALL", text, "base")


def _foot(stats: Stats, foot: FootFigures) -> Iterator[Finding]:
    record, name, where = foot.record, foot.name, f"feet.{foot.name}"
    if record.messages == 0:
        yield Finding("W_NO_MESSAGES", f"no message on {foot.topic} tells of {name}", where)
        return
    if record.start is None:
        yield Finding("W_NOTHING_USABLE", f"no message of {name} can be used", where)
        return
    if foot.is_dead:
        text = f"{name} never touches the ground: its sensor seems dead, or the foot is lifted"
        yield Finding("W_DEAD", text, where)
        return
    if len(foot.stances.touchdown) == 0:
        text = f"{name} never touches the ground, and the other feet carry the whole weight"
        yield Finding("N_LIFTED", text, where)
        return
    yield from _sensor(foot, where)
    if foot.stance_s is None:
        text = f"no stance of {name} is seen from touchdown to lift-off: no stance figures"
        yield Finding("N_NO_STANCES", text, f"{where}.stance_s")
    if not len(foot.strides.stance):
        text = f"{name} makes no whole stride, so it has no stride figures"
        yield Finding("N_NO_STRIDES", text, f"{where}.strides")
    yield from _force_reasons(stats, foot, where)
    if foot.stance_s is not None:
        yield from _stance_reasons(foot, where)
    without_pose = stats.contact_without_pose_s[stats.feet.index(foot)]
    if len(stats.base_record.time) and without_pose > SOME_S:
        text = f"{name} is in contact for {without_pose:.1f} s further than 0.1 s from odometry"
        yield Finding("W_CONTACT_WITHOUT_ODOMETRY", text, where)


def _sensor(foot: FootFigures, where: str) -> Iterator[Finding]:
    record, name = foot.record, foot.name
    if is_stuck(record):
        text = f"the sensor of {name} shows one constant force while it is loaded: stuck"
        yield Finding("W_STUCK", text, where)
    if is_saturated(record):
        text = f"peaks of {name} are flat and equal: its sensor seems saturated"
        yield Finding("W_SATURATED", text, where)
    if record.not_finite:
        messages = _count(record.not_finite, "message")
        text = f"{messages} of {name} with a force that is not finite; left out"
        yield Finding("W_NOT_FINITE", text, where)
    if record.not_advancing:
        messages = _count(record.not_advancing, "message")
        text = f"{messages} of {name} with a time that repeats or steps back; left out"
        yield Finding("W_NOT_ADVANCING", text, where)
    chatter = record.filled_swings + record.dropped_stances
    if chatter > max(2.0, 0.2 * len(foot.stances.touchdown)):
        text = (
            f"{name} chatters: {record.filled_swings} short swings filled, "
            f"{record.dropped_stances} short stances dropped"
        )
        yield Finding("W_CHATTER", text, f"{where}.chatter")


def _force_reasons(stats: Stats, foot: FootFigures, where: str) -> Iterator[Finding]:
    if not foot.record.has_force:
        text = f"the sensor of {foot.name} tells contact, not force: it has no force figures"
        yield Finding("N_NO_FORCE", text, f"{where}.peak_force_n")
    elif not vertical_is_known(foot.record):
        text = (
            f"wrenches of {foot.name} are not in the world frame ({stats.settings.wrench_frame}): "
            "only the magnitude of its force is known, vertical and tangential parts are not"
        )
        yield Finding("N_VERTICAL_UNKNOWN", text, f"{where}.peak_vertical_force_n")


def _stance_reasons(foot: FootFigures, where: str) -> Iterator[Finding]:
    name = foot.name
    if foot.loading_rate_nps is None and foot.record.has_force:
        text = f"{name} is loaded within one sampling interval: its loading rate is not resolved"
        yield Finding("N_LOADING_RATE_UNRESOLVED", text, f"{where}.loading_rate_nps")
    if foot.contact_travel_m is None:
        text = f"no contact points of {name} around 10 % and 90 % of a stance: no travel, no slip"
        yield Finding("N_NO_CONTACT_POINTS", text, f"{where}.contact_travel_m")
    if foot.friction_use is None and vertical_is_known(foot.record):
        text = f"no contact normals of {name}: its friction use is not known"
        yield Finding("N_NO_NORMALS", text, f"{where}.friction_use")
    if foot.strides.stance.size and foot.stride_length_m is None:
        text = f"no odometry around the touchdowns of {name}: its stride length is not known"
        yield Finding("N_NO_STRIDE_LENGTH", text, f"{where}.stride_length_m")


def _base(stats: Stats) -> Iterator[Finding]:
    record, base = stats.base_record, stats.base
    if record.messages and record.not_usable == record.messages:
        poses = _count(record.messages, "pose")
        text = f"the odometry is useless: {poses}, all with NaN, infinity or a zero quaternion"
        yield Finding("W_BAD_POSES", f"{text}; no base figures", "base")
        return
    if base is None:
        yield Finding("N_NO_ODOMETRY", "fewer than two poses of the base: no base figures", "base")
        return
    if record.not_usable:
        poses = _count(record.not_usable, "pose")
        text = f"{poses} with a zero quaternion or a number that is not finite; left out"
        yield Finding("W_BAD_POSES", text, "base")
    if record.not_advancing:
        poses = _count(record.not_advancing, "pose")
        text = f"{poses} with a time that repeats or steps back; left out"
        yield Finding("W_NOT_ADVANCING", text, "base")
    if base.twist_frame == "world":
        text = "odometry's twist is in the world frame, although its message says child frame"
        yield Finding("N_TWIST_IN_WORLD", text, "base.twist_frame")
    if base.twist_frame == "ambiguous":
        text = "the frame of odometry's twist cannot be told: both readings fit the poses alike"
        yield Finding("N_TWIST_AMBIGUOUS", text, "base.twist_frame")
    if base.twist_frame is None:
        text = "too few finite velocities between poses to tell the twist's frame"
        yield Finding("N_TWIST_UNKNOWN", text, "base.twist_frame")
    if base.froude is None:
        text = "the base's mean height is below 1 mm in the world: no Froude number"
        yield Finding("N_NO_FROUDE", text, "base.froude")
    yield from _heading(stats, base)
    speed = _fastest_step_mps(stats)
    if speed is not None and speed > 20.0:
        text = f"the base jumps: two poses are {speed:.0f} m/s apart"
        yield Finding("W_POSE_JUMP", text, "base.path_length_m")


def _heading(stats: Stats, base: BaseMotion) -> Iterator[Finding]:
    forward, left = base.forward_speed_mps, base.lateral_speed_mps
    if forward is None or left is None or abs(left) * base.duration_s < WALKED_M:
        return
    if abs(left) > 2.0 * abs(forward):
        axis, side = stats.settings.forward_axis, "left" if left > 0.0 else "right"
        text = (
            f"the robot moves to the {side} of its forward axis {axis}, at {abs(left):.2f} m/s "
            f"against {forward:.2f} m/s forward: if it does not walk sideways, another "
            "--forward-axis is right"
        )
        yield Finding("W_MOVES_SIDEWAYS", text, "base.forward_speed_mps")


def _fastest_step_mps(stats: Stats) -> float | None:
    record = stats.base_record
    speeds = norms(np.diff(record.position, axis=0)) / (np.diff(record.time) / 1e9)
    return float(speeds.max()) if len(speeds) else None


def _gait(stats: Stats) -> Iterator[Finding]:
    main, where = stats.main, "gait.class"
    reference = stats.feet[stats.reference].name if stats.feet else ""
    if stats.support is None:
        text = "there is no time in which the state of every foot is known"
        yield Finding("N_NO_SUPPORT", text, "gait.support")
    if main is None:
        text = "no foot makes a whole stride, and not all feet stand: the gait is not known"
        yield Finding("N_NO_GAIT", text, where)
        return
    if stats.reference:
        text = f"{stats.feet[0].name} has no strides: phases are measured against {reference}"
        yield Finding("N_REFERENCE_FOOT", text, "gait.phase")
    if main.gait.name is None:
        yield Finding("N_CLASS_UNKNOWN", _why_no_class(stats), where)
    elif main.gait.name == IRREGULAR:
        yield Finding("N_IRREGULAR", _why_irregular(stats), where)
    classes = {segment.gait.name for segment in stats.segments}
    if len(classes) > 1:
        text = (
            f"the log holds {len(stats.segments)} segments of different gaits; the class is that "
            "of the longest"
        )
        yield Finding("N_SEVERAL_GAITS", text, "gait.segments")


def _why_no_class(stats: Stats) -> str:
    if len(stats.feet) != QUADRUPED:
        return f"only gaits of four feet have names; this robot has {len(stats.feet)}"
    if stats.corners is None:
        return (
            "a gait's name needs to know which foot is front or back, left or right: "
            "`place` in a robot's file says so"
        )
    main = stats.main
    missing = [
        foot.name
        for row, foot in enumerate(stats.feet)
        if main is not None and main.phases[row] is None
    ]
    return f"{', '.join(missing)} has no touchdowns in the strides of the reference foot"


def _why_irregular(stats: Stats) -> str:
    main = stats.main
    loose = [
        f"{foot.name} (R = {phase.consistency:.2f})"
        for foot, phase in zip(stats.feet, main.phases if main else (), strict=False)
        if phase is not None and phase.consistency <= CONSISTENT
    ]
    if loose:
        return f"phases are not consistent: {', '.join(loose)}"
    gait = main.gait if main else None
    if gait is None or gait.distance is None:
        return "the phases fit no class"
    return f"the phases fit no class; the nearest is {gait.nearest}, {gait.distance:.2f} cycles off"


def _loads(stats: Stats) -> Iterator[Finding]:
    settings, loads = stats.settings, stats.loads
    if settings.mass_kg is None:
        text = "the robot's mass is not known: nothing is given in body weights"
        yield Finding("N_NO_MASS", text, "forces.vertical_impulse_over_weight")
    ratio = loads.vertical_impulse_over_weight
    if ratio is not None and abs(ratio - 1.0) > WEIGHT_TOLERANCE:
        yield Finding(
            "W_IMPULSE_IS_NOT_WEIGHT", _why_not_weight(ratio), "forces.vertical_impulse_over_weight"
        )
    if loads.share_of == "force_impulse":
        text = (
            "load shares are of the integral of |F|, since vertical forces are not known; "
            "the impulse over weight is not known either"
        )
        yield Finding("N_SHARES_OF_MAGNITUDE", text, "forces.load_share")
    if loads.shares is None:
        text = "not every foot's load is known, or there is none: no load shares"
        yield Finding("N_NO_SHARES", text, "forces.load_share")


def _why_not_weight(ratio: float) -> str:
    text = f"the feet's vertical impulse is {ratio:.2f} of the weight: "
    if ratio < 0.1:
        return text + "are the wrenches in a link's frame after all?"
    if abs(ratio - round(ratio)) < WEIGHT_TOLERANCE and ratio > 1.5:
        return text + "were several physics steps added up?"
    return text + "the mass, a sensor, or something else that carries the robot is not as assumed"


def _stability(stats: Stats) -> Iterator[Finding]:
    if stats.stability is None:
        text = "there is no time in which the base and the state of every foot are known"
        yield Finding("N_NO_STABILITY", text, "stability")
    elif stats.stability.static_margin_m is None:
        text = "there are never three feet with a contact point down at once: no static margin"
        yield Finding("N_NO_MARGIN", text, "stability.static_margin_m")
    if stats.stability is not None and stats.stability.pressure_forward_m is None:
        text = "vertical forces are not known: no centre of pressure"
        yield Finding("N_NO_CENTRE_OF_PRESSURE", text, "stability.centre_of_pressure_forward_m")


def _topic(topic: TopicQuality) -> Iterator[Finding]:
    name = topic.topic
    if topic.gaps:
        longest = topic.longest_gaps[0].length_s if topic.longest_gaps else 0.0
        gaps = _count(topic.gaps, "gap")
        text = f"{gaps}, {topic.gaps_total_s:.2f} s in all, the longest {longest:.2f} s"
        yield Finding("W_GAPS", f"{name}: {text}", name)
    for code, count, what in (
        ("W_ZERO_STAMPS", topic.zero_stamps, "with a zero header stamp"),
        ("W_BACKWARD_STAMPS", topic.backward_stamps, "with a header stamp that goes backwards"),
        ("W_DUPLICATE_STAMPS", topic.duplicate_stamps, "with the header stamp of the one before"),
        ("W_BACKWARD_LOG_TIMES", topic.backward_log_times, "logged out of order"),
        ("N_DUPLICATE_LOG_TIMES", topic.duplicate_log_times, "with the log time of the one before"),
    ):
        # Stamps that are all zero repeat each other: said once.
        if count and not (code == "W_DUPLICATE_STAMPS" and topic.zero_stamps):
            messages = _count(topic.messages, "message")
            yield Finding(code, f"{name}: {count} of {messages} {what}", name)
    if topic.offset_drift_ppm is not None and abs(topic.offset_drift_ppm) > 1e4:
        rate = 1.0 / (1.0 + topic.offset_drift_ppm / 1e6)
        text = f"{name}: its stamps run at {rate:.2f} times the speed of log time"
        yield Finding("N_CLOCKS_DIFFER", text, name)
