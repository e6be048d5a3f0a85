"""Is a result right, or null with its cause named? Every figure against the truth."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np

from tests.truth.case import Case, Tolerance
from tests.truth.geometry import Floats
from tests.truth.outcome import Outcome, nearest
from tests.truth.recording import Recording, Truth

Status = Literal["right", "null", "wrong", "unexplained"]
"""``null``: with a finding that names the cause; ``unexplained``: null without one."""
EDGE_S: Final = 0.15
"""Events this near to an end of the log are not judged."""


@dataclass(frozen=True, slots=True)
class Judged:
    """A figure of all feet, or of the log."""

    figure: str
    truth: str
    result: str
    status: Status
    why: str = ""


OF_POINTS: Final = {"margin", "unstable margin", "energy margin", "pressure", "friction", "slip",
                   "largest slip", "contact travel"}  # fmt: skip
"""Figures of contact points."""
OF_SOUND_LOGS: Final = {"vertical_impulse_ns", "undefined_fraction", "unknown_fraction",
                        "contact_travel_m", "loading_rate_nps", "impact_ratio",
                        "friction_use"}  # fmt: skip
"""Metrics that faults change."""
STEPS: Final = {"touchdown", "lift_off"}
SENSOR_FAULTS: Final = {"STUCK", "DEAD", "STOPPED", "SATURATED", "SPIKES"}
"""Findings of which events tell, too."""
FALL_S: Final = 0.1
FALLS: Final = "the robot falls"
SILENCE: Final = r"GAPS|SILEN"
"""Pattern of findings that name silences, in which events are not known."""
HIDDEN: Final = 0.1
"""Largest part of the events that they may hide outside of the silences that a case knows of."""
STRUCTURAL: Final = {
    "size": "no forces",
    "load share": "no forces",
    "peak force": "frame of the forces|no forces",
    "braking": "frame of the forces|no forces",
    "impulse": "frame of the forces|no forces|mass not known",
    "height": "height|no contact points",
    "energy margin": "height|no contact points",
    "froude": "height|no contact points",
    "slip": "foot_rolling_m|no contact points",
    "largest slip": "foot_rolling_m|no contact points",
    "contact travel": "no contact points",
    "loading": "no forces",
    "impact": "no forces|below 100 Hz",
    "friction": "frame of the forces|no contact normals",
    "forces over it": "frame of the forces",
    "slope": "no contact points|no plane|does not apply",
}
"""Reasons that excuse a metric's being null in any log: what it needs was not recorded."""


def judge(case: Case, recording: Recording, found: Outcome) -> list[Judged]:
    """Judge all figures of a case."""
    truth = recording.truth
    judged = [*_gait(case, truth, found), *_verdict(case, truth, found)]
    judged += _odd_events(case, truth, found)
    judged += _steps(case, recording, found) if truth.stride_s else _no_steps(recording, found)
    judged += _numbers(case, recording, found)
    skipped = case.skip.split(", ")
    judged = [each for each in judged if each.figure not in skipped]
    return judged + [each for each in _unknown(judged, found) if each.figure not in skipped]


def faults(judged: Sequence[Judged]) -> list[Judged]:
    """Return what is neither right nor null with a cause."""
    return [each for each in judged if each.status in {"wrong", "unexplained"}]


def _excused(case: Case, figure: str, found: Outcome) -> Status:
    """Judge that a figure is null."""
    if figure in case.known.split(", "):
        return "unexplained"
    patterns = [case.excuse, STRUCTURAL.get(figure, "")]
    named = any(pattern and (found.says(pattern) or found.lacks(pattern)) for pattern in patterns)
    return "null" if named else "unexplained"


def _unknown(judged: Sequence[Judged], found: Outcome) -> Iterator[Judged]:
    """A log of which a figure is null for a fault of the log is not simply trusted."""
    null = [each.figure for each in judged if each.status == "null"]
    says_so = found.quality != "OK" or "could not be made" in found.quality_line
    if not says_so and set(null) - set(STRUCTURAL):
        yield Judged("verdict", f"care: no {', '.join(null)}", found.quality_line, "wrong")


def _gait(case: Case, truth: Truth, found: Outcome) -> Iterator[Judged]:
    name = found.figure("gait.name")
    status = _right(name == truth.gait_class)
    if name is None and truth.gait_class is not None:
        status = _excused(case, "class", found)
    yield Judged("class", str(truth.gait_class), str(name), status)
    if truth.sequence is not None and name is not None:
        sequence = found.figure("gait.sequence")
        status = "right" if sequence == truth.sequence else "wrong"
        yield Judged("sequence", truth.sequence, str(sequence), status)


def _verdict(case: Case, truth: Truth, found: Outcome) -> Iterator[Judged]:
    codes = ", ".join(found.warnings())
    if case.says:
        said = found.says(case.says)
        status: Status = "right" if said else "wrong"
        yield Judged("finding", case.says, ", ".join(said) or f"none of [{codes}]", status)
    if not case.says and not case.excuse:
        yield Judged("verdict", "OK", f"{found.quality} [{codes}]", _right(found.quality == "OK"))
    fell = [each["onset_s"] for each in found.figure("events") if each["type"] == "fall"]
    near = all(abs(a - b) <= FALL_S for a, b in zip(fell, truth.falls_s, strict=False))
    is_right = near and len(fell) == len(truth.falls_s) and bool(fell) == bool(found.says(FALLS))
    yield Judged("fall", _joined(truth.falls_s), _joined(fell), _right(is_right))
    if truth.falls_s:
        reported = "fall" in found.headline.lower() or "fell" in found.headline.lower()
        yield Judged("headline", "fall", found.headline, _right(reported))


def _odd_events(case: Case, truth: Truth, found: Outcome) -> Iterator[Judged]:
    """Judge what happens beside steps and falls, but for feet that a seam moves at once."""
    events: list[Any] = [each for each in found.figure("events") if each["type"] not in STEPS]
    faulty = {each["code"] for each in events if each["type"] == "sensor_fault"}
    named = {each["code"] for each in found.json["findings"]} & SENSOR_FAULTS
    yield Judged(
        "faulty sensors", _joined(sorted(named)), _joined(sorted(faulty)), _right(named == faulty)
    )
    if case.happens is None:
        return

    unjudged = {
        "fall",
        "sensor_fault",
        *(["margin_below_zero"] if truth.metrics.get("unstable_fraction") else []),
    }

    def is_odd(event: Mapping[str, Any]) -> bool:
        moved = any(abs(event["onset_s"] - seam) < 0.02 for seam in truth.seams_s)
        return event["type"] not in unjudged and not (event["foot"] and moved)

    odd = list(filter(is_odd, events))
    pairs = zip(case.happens, odd, strict=False)
    is_right = len(odd) == len(case.happens) and all(a.is_told_by(b) for a, b in pairs)
    told = [f"{each['type']} of {each['foot']} at {each['onset_s']:.3f} s" for each in odd]
    true = [f"{each.type} of {each.foot} at {each.onset_s:.3f} s" for each in case.happens]
    yield Judged("events", _joined(true), _joined(told), _right(is_right))


def _no_steps(recording: Recording, found: Outcome) -> Iterator[Judged]:
    strides = [found.figure(f"feet.{name}.strides") for name in recording.robot.feet]
    yield Judged("strides", "0", _joined(strides), _right(not any(strides)))


def _steps(case: Case, recording: Recording, found: Outcome) -> Iterator[Judged]:
    yield from _events(case, recording, found)
    without = set(found.json["feet"]) - set(recording.robot.feet)
    told = [found.figure(f"feet.{foot}.contact_fraction") for foot in without]
    if any(fraction is not None for fraction in told):
        yield Judged("feet without sensors", "null", _joined(told), "wrong")
    yield _phases(case, recording, found)
    if recording.truth.segments:
        classes = tuple(each["gait"]["name"] for each in found.figure("gait.segments"))
        status = _right(classes == recording.truth.segments)
        yield Judged("segments", _joined(recording.truth.segments), _joined(classes), status)


def _figures(allow: Tolerance, stride_s: float) -> Iterator[tuple[str, str, str, float, float]]:
    """Yield metrics: figure, key, and how far it may be off, at least and of the truth.

    In a key, * stands for each foot, @ for its topic, and # for each number of feet.
    """
    contact, force, margin = allow.contact, allow.force, allow.margin
    yield from (
        ("contact_fraction", "contact fraction", "feet.*.contact_fraction", contact, 0.0),
        ("duty_factor", "duty factor", "feet.*.duty_factor.mean", allow.duty, 0.0),
        ("stance_s", "stance", "feet.*.stance_s.median", allow.duty * stride_s, 0.0),
        ("swing_s", "stance", "feet.*.swing_s.median", allow.duty * stride_s, 0.0),
        ("stride_period_s", "stride period", "feet.*.stride_period_s.median", 0.0, 0.01),
        ("stride_frequency_hz", "stride period", "gait.stride_frequency_hz", 0.0, 0.01),
        ("stride_length_m", "stride length", "feet.*.stride_length_m.mean", 0.01, 0.04),
        ("peak_force_n", "size", "feet.*.peak_force_n.mean", 0.0, force),
        ("mean_force_n", "size", "feet.*.mean_force_n.mean", 0.0, force + 0.03),
        ("peak_vertical_force_n", "peak force", "feet.*.peak_vertical_force_n.mean", 0.0, force),
        ("mean_vertical_force_n", "peak force", "feet.*.mean_vertical_force_n.mean", 0.0,
         force + 0.03),
        ("vertical_impulse_ns", "impulse", "feet.*.vertical_impulse_ns", 0.0, 0.05),
        ("braking_impulse_ns", "braking", "feet.*.braking_impulse_ns.mean", 0.01, 0.1),
        ("propulsive_impulse_ns", "braking", "feet.*.propulsive_impulse_ns.mean", 0.0, 0.1),
        ("slip_m", "slip", "feet.*.slip_m.median", 0.004, 0.0),
        ("slip_largest_m", "largest slip", "feet.*.slip_largest_m.median", 0.004, 0.0),
        ("contact_travel_m", "contact travel", "feet.*.contact_travel_m.median", 0.0005, 0.01),
        ("loading_rate_nps", "loading", "feet.*.loading_rate_nps.median", 0.0, 0.07),
        ("impact_ratio", "impact", "feet.*.impact_ratio.median", 0.04, 0.12),
        ("friction_use", "friction", "feet.*.friction_use.median", 0.001, 0.02),
        ("load_share", "load share", "forces.load_share.feet.*", 0.02, 0.0),
        ("load_share_fore", "load share", "forces.load_share.fore", 0.04, 0.0),
        ("load_share_left", "load share", "forces.load_share.left", 0.04, 0.0),
        ("impulse_over_weight", "impulse", "forces.vertical_impulse_over_weight", 0.03, 0.0),
        ("support", "support", "gait.support.#", 3.5 * contact, 0.0),
        ("flight_fraction", "support", "gait.flight_fraction", 3.5 * contact, 0.0),
        ("forward_speed_mps", "speed", "base.forward_speed_mps", 0.01, 0.02),
        ("lateral_speed_mps", "lateral speed", "base.lateral_speed_mps", 0.01, 0.02),
        ("yaw_rate_radps", "yaw rate", "base.yaw_rate_radps", 0.01, 0.0),
        ("yaw_change_rad", "yaw rate", "base.yaw_change_rad", 0.02, 0.01),
        ("path_length_m", "path", "base.path_length_m", 0.05, 0.02),
        ("net_displacement_m", "path", "base.net_displacement_m", 0.05, 0.02),
        ("height_m", "height", "base.height_m.mean", 0.0, 0.02),
        ("froude", "froude", "base.froude", 0.001, 0.05),
        ("slope_rad", "slope", "base.slope_rad", 0.01, 0.0),
        ("pitch_rad", "pitch", "base.pitch_rad.mean", 0.01, 0.0),
        ("climb_m", "climb", "base.climb_m", 0.05, 0.0),
        ("static_margin_m", "margin", "stability.static_margin_m.mean", margin, 0.0),
        ("energy_margin_m", "energy margin", "stability.energy_margin_m.mean", 0.3 * margin, 0.0),
        ("unstable_fraction", "unstable margin", "stability.unstable_fraction", 0.03, 0.0),
        ("undefined_fraction", "unstable margin", "stability.undefined_fraction", 3.5 * contact,
         0.0),
        ("unknown_fraction", "unstable margin", "stability.unknown_fraction", 0.01, 0.0),
        ("pressure_forward_m", "pressure", "stability.centre_of_pressure_forward_m.mean",
         1.5 * margin, 0.0),
        ("pressure_left_m", "pressure", "stability.centre_of_pressure_left_m.mean", 1.5 * margin,
         0.0),
        ("accelerometer_mps2", "accelerometer", "imu.accelerometer_mps2", 0.1, 0.0),
        ("forces_over_accelerometer", "forces over it", "imu.forces_over_accelerometer", 0.01, 0.0),
        ("rate_hz", "topics", "quality.topics.@.rate_hz", 0.0, 0.01),
        ("gaps", "topics", "quality.topics.@.gaps", 0.0, 0.0),
        ("bad_stamps", "topics", "quality.topics.@.bad_stamps", 0.0, 0.0),
    )  # fmt: skip


def _numbers(case: Case, recording: Recording, found: Outcome) -> Iterator[Judged]:
    """Judge every metric of which the truth is known."""
    truth, robot = recording.truth, recording.robot
    metrics: dict[str, Any] = {**truth.metrics}
    if case.faults:
        metrics = {name: metrics[name] for name in metrics.keys() - OF_SOUND_LOGS}
    else:
        metrics |= {"rate_hz": case.rate_hz, "gaps": 0.0, "bad_stamps": 0.0}
    topics = [robot.topic(row) for row in range(len(robot.feet))]
    counts = [str(count) for count in range(len(metrics.get("support") or ()))]
    each = {"*": robot.feet, "@": topics, "#": counts}
    for metric, figure, key, least, share in _figures(case.tolerance, truth.stride_s or 1.0):
        true = metrics.get(metric)
        is_told = figure not in OF_POINTS or recording.kind in {"contacts", "gz_contacts"}
        if true is None or not is_told:
            continue
        mark = next((mark for mark in each if mark in key), "")
        keys = [key.replace(mark, name) for name in each[mark]] if mark else [key]
        wanted = true if isinstance(true, tuple) else (true,) * len(keys)
        yield _numbers_of(case, found, figure, keys, wanted, max(least, share * abs(wanted[0])))


def _numbers_of(
    case: Case,
    found: Outcome,
    name: str,
    keys: Sequence[str],
    wanted: Sequence[float],
    within: float,
) -> Judged:
    """Judge one metric, of each foot or of the log."""
    values = [found.figure(key) for key in keys]
    pairs = zip(values, wanted, strict=True)
    status: Status = "right"
    if not all(value is None or abs(value - true) <= within for value, true in pairs):
        # The impulse is a check: where it fails and that is said, it is no wrong statement.
        is_said = name == "impulse" and case.excuse and found.says("IMPULSE_IS_NOT_WEIGHT")
        status = "null" if is_said else "wrong"
    elif None in values:
        status = _excused(case, name, found)
    return Judged(name, _joined(wanted), _joined(values), status, f"within {within:.3g}")


def _phases(case: Case, recording: Recording, found: Outcome) -> Judged:
    names = recording.robot.feet
    values = [found.figure(f"gait.phase.{name}.mean") for name in names]
    wanted: Any = recording.truth.metrics["phase"]
    known = [(v, w) for v, w in zip(values, wanted, strict=True) if v is not None]
    # Phases may count from another foot than the first.
    turns = np.exp(2j * np.pi * np.array([v - w for v, w in known])) if known else np.ones(1)
    off = np.abs(np.angle(turns / turns[0])) / (2.0 * np.pi)
    status: Status = _right(bool(off.max() <= 0.03))
    if status == "right" and None in values:
        status = _excused(case, "phase", found)
    return Judged("phase", _joined(wanted), _joined(values), status)


def _events(case: Case, recording: Recording, found: Outcome) -> Iterator[Judged]:
    for name, key in (("touchdowns", "touchdown_s"), ("lift-offs", "lift_off_s")):
        missed = invented = silent_feet = 0
        errors: list[float] = []
        steps = zip(recording.robot.feet, getattr(recording.truth, key), strict=True)
        for foot, times in steps:
            reported = np.array(found.figure(f"feet.{foot}.{key}") or [])
            if not len(reported) and found.figure(f"feet.{foot}.contact_fraction") is None:
                silent_feet += 1
                continue
            true = np.array(times)
            late, extra = match_events(true, reported, recording.seconds, case)
            errors += [each for each in late if each is not None]
            missed += late.count(None)
            invented += extra
        worst = max(map(abs, errors), default=0.0)
        none_at_all = not errors and not invented
        right = not invented and worst <= case.tolerance.event_s
        # A silence hides the events in it, and those that it cannot be told from.
        few = missed <= HIDDEN * (missed + len(errors)) and found.says(SILENCE)
        status = _right(none_at_all or (right and (not missed or bool(few))))
        if status == "right" and (missed or silent_feet):
            status = _excused(case, name, found)
        result = f"{len(errors)}, at most {worst:.3f} s off; {missed} missed, {invented} invented"
        yield Judged(name, "all", result, status)


def match_events(
    true: Floats, reported: Floats, seconds: float, case: Case
) -> tuple[list[float | None], int]:
    """Return how late each true event is reported, and how many are that are not true.

    None: it is not, within twice the tolerance.
    """
    if case.shifted and len(true) and len(reported):
        reported = reported - np.median(reported - nearest(true, reported))
    gap = case.silence_s or (0.0, 0.0)

    def inside(times: Floats) -> Floats:
        silent = (times > gap[0] - EDGE_S) & (times < gap[1] + EDGE_S)
        return np.asarray(times[(times > EDGE_S) & (times < seconds - EDGE_S) & ~silent])

    reach = 2.0 * case.tolerance.event_s
    expected, told = inside(true), inside(reported)
    late = nearest(reported, expected) - expected
    extra = np.abs(nearest(true, told) - told) > reach
    return [each if abs(each) <= reach else None for each in late.tolist()], int(extra.sum())


def _right(is_right: bool) -> Status:  # noqa: FBT001 - a word for it
    return "right" if is_right else "wrong"


def _joined(values: Sequence[object]) -> str:
    texts = [f"{value:.4g}" if isinstance(value, float) else str(value) for value in values]
    return texts[0] if len(set(texts)) == 1 else "/".join(texts) or "none"
