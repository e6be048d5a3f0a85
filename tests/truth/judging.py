"""Is a result right, or null with its cause named? Every figure against the truth."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np

from tests.truth.case import Case
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


_OF_POINTS: Final = {"margin", "unstable margin", "energy margin", "pressure"}
"""Figures of contact points."""
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
    "peak force": "frame of the forces",
    "braking": "frame of the forces",
    "propulsion": "frame of the forces",
    "impulse": "frame of the forces|mass not known",
    "height": "height|no contact points",
    "energy margin": "height|no contact points",
    "froude": "height|no contact points",
    "slip": "foot_rolling_m|no contact points",
    "forces over it": "frame of the forces",
    "slope": "no contact points|no plane|does not apply",
}
"""Reasons that excuse a metric's being null in any log: what it needs was not recorded."""


def judge(case: Case, recording: Recording, found: Outcome) -> list[Judged]:
    """Judge all figures of a case."""
    judged = [*_gait(case, recording.truth, found), *_verdict(case, recording.truth, found)]
    judged += _odd_events(case, recording.truth, found)
    walks = recording.truth.feet[0].stride_period_s is not None
    judged += _walk(case, recording, found) if walks else _no_steps(recording, found)
    judged += _whole(case, recording, found)
    judged = [each for each in judged if each.figure not in case.skipped]
    return judged + [each for each in _unknown(judged, found) if each.figure not in case.skipped]


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
    allowed = (truth.gait_class,) if case.classes is None else case.classes
    name = found.figure("gait.name")
    status: Status = "right" if name in allowed else "wrong"
    if name is None and None not in allowed:
        status = _excused(case, "class", found)
    yield Judged("class", _joined(allowed), str(name), status)
    if truth.sequence is not None and name is not None and case.classes is None:
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

    unjudged = {"fall", "sensor_fault", *(["margin_below_zero"] if truth.unstable_fraction else [])}

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


def _walk(case: Case, recording: Recording, found: Outcome) -> Iterator[Judged]:
    allow, truth, names = case.tolerance, recording.truth, recording.robot.feet
    yield from _events(case, recording, found)
    without = set(found.json["feet"]) - set(names)
    told = [found.figure(f"feet.{foot}.contact_fraction") for foot in without]
    if any(fraction is not None for fraction in told):
        yield Judged("feet without sensors", "null", _joined(told), "wrong")
    # Name, key, whose first part is the truth's field, how far it may be off, and whether of it.
    period_s = truth.feet[0].stride_period_s or 1.0
    of_feet = (
        ("contact fraction", "contact_fraction", allow.contact, False),
        ("duty factor", "duty_factor.mean", allow.duty, False),
        ("stance", "stance_s.median", allow.duty * period_s, False),
        ("stance", "swing_s.median", allow.duty * period_s, False),
        ("stride period", "stride_period_s.median", allow.period, True),
        ("stride length", "stride_length_m.mean", allow.length, True),
        ("size", "peak_force_n.mean", allow.force, True),
        ("size", "mean_force_n.mean", allow.force + 0.03, True),
        ("peak force", "peak_vertical_force_n.mean", allow.force, True),
        ("peak force", "mean_vertical_force_n.mean", allow.force + 0.03, True),
        ("braking", "braking_impulse_ns.mean", 0.1, True),
        ("slip", "slip_m.median", 0.004, False),
    )
    for name, key, allowed, is_relative in of_feet:
        wanted = [getattr(each, key.partition(".")[0]) for each in truth.feet]
        if None not in wanted and not (name == "slip" and recording.kind == "wrench"):
            keys = [f"feet.{foot}.{key}" for foot in names]
            within = allowed * (wanted[0] or 1.0) if is_relative else allowed
            yield _numbers(case, found, name, keys, wanted, within)
    shares = [each.load_share for each in truth.feet]
    keys = [f"forces.load_share.feet.{foot}" for foot in names]
    yield _numbers(case, found, "load share", keys, shares, allow.share)
    braked = [each.braking_impulse_ns for each in truth.feet]
    keys = [f"feet.{foot}.propulsive_impulse_ns.mean" for foot in names]
    yield _numbers(case, found, "propulsion", keys, braked, 0.1 * (braked[0] or 0.0))
    frequency, hertz = ["gait.stride_frequency_hz"], 1.0 / period_s
    yield _numbers(case, found, "stride period", frequency, [hertz], allow.period * hertz)
    if len(names) == 4:
        pairs = [sum(share or 0.0 for share in pair) for pair in (shares[:2], shares[::2])]
        keys = [f"forces.load_share.{side}" for side in ("fore", "left")]
        yield _numbers(case, found, "load share", keys, pairs, 2.0 * allow.share)
    yield _phases(case, recording, found)
    if not case.faults:
        topics = [f"quality.topics.{recording.robot.topic(row)}" for row in range(len(names))]
        for key, true in (("rate_hz", case.rate_hz), ("gaps", 0.0), ("bad_stamps", 0.0)):
            keys, rates = [f"{topic}.{key}" for topic in topics], [true] * len(topics)
            yield _numbers(case, found, "topics", keys, rates, 0.01 * true)
        pushed = [each.vertical_impulse_ns for each in truth.feet]
        keys = [f"feet.{foot}.vertical_impulse_ns" for foot in names]
        if None not in pushed:
            yield _numbers(case, found, "impulse", keys, pushed, 0.05 * (pushed[0] or 0.0))
    if truth.support is not None:
        keys = [f"gait.support.{count}" for count in truth.support]
        parts = list(truth.support.values())
        yield _numbers(case, found, "support", keys, parts, 3.5 * allow.contact)
        flight = ["gait.flight_fraction"]
        yield _numbers(case, found, "support", flight, parts[:1], 3.5 * allow.contact)
    if truth.segments:
        classes = tuple(each["gait"]["name"] for each in found.figure("gait.segments"))
        status = _right(classes == truth.segments)
        yield Judged("segments", _joined(truth.segments), _joined(classes), status)


def _whole(case: Case, recording: Recording, found: Outcome) -> Iterator[Judged]:
    truth, allow = recording.truth, case.tolerance
    speed = truth.forward_speed_mps
    within = max(allow.speed * speed, 0.01)
    turned_rad = truth.yaw_rate_radps and truth.yaw_rate_radps * recording.seconds
    push = 1.5 * allow.margin
    undefined = None if case.faults else truth.undefined_fraction
    unknown = None if undefined is None else 0.0
    wanted: tuple[tuple[str, str, float | None, float], ...] = (
        ("speed", "base.forward_speed_mps", speed, within),
        ("lateral speed", "base.lateral_speed_mps", truth.lateral_speed_mps, within),
        ("yaw rate", "base.yaw_rate_radps", truth.yaw_rate_radps, 0.01),
        ("path", "base.path_length_m", truth.path_length_m,
         0.05 + allow.speed * (truth.path_length_m or 0.0)),
        ("path", "base.net_displacement_m", truth.net_displacement_m,
         0.05 + allow.speed * (truth.net_displacement_m or 0.0)),
        ("yaw rate", "base.yaw_change_rad", turned_rad, 0.02 + 0.01 * abs(turned_rad or 0.0)),
        ("height", "base.height_m.mean", truth.height_m, 0.02 * (truth.height_m or 0.0)),
        ("impulse", "forces.vertical_impulse_over_weight", truth.impulse_over_weight,
         allow.impulse),
        ("margin", "stability.static_margin_m.mean", truth.static_margin_m, allow.margin),
        ("unstable margin", "stability.unstable_fraction", truth.unstable_fraction, 0.03),
        ("unstable margin", "stability.undefined_fraction", undefined, 3.5 * allow.contact),
        ("unstable margin", "stability.unknown_fraction", unknown, 0.01),
        ("pressure", "stability.centre_of_pressure_forward_m.mean", truth.pressure_m[0], push),
        ("pressure", "stability.centre_of_pressure_left_m.mean", truth.pressure_m[1], push),
        ("energy margin", "stability.energy_margin_m.mean", truth.energy_margin_m,
         0.3 * allow.margin),
        ("froude", "base.froude", truth.froude, 0.05 * (truth.froude or 0.0)),
        ("slope", "base.slope_rad", abs(truth.slope_rad), 0.01),
        ("pitch", "base.pitch_rad.mean", truth.pitch_rad, 0.01),
        ("climb", "base.climb_m", truth.climb_m, 0.05),
        ("accelerometer", "imu.accelerometer_mps2", truth.felt_mps2, 0.1),
        ("forces over it", "imu.forces_over_accelerometer", truth.felt_mps2 and 1.0, 0.01),
    )  # fmt: skip
    for name, key, true, allowed in wanted:
        if true is None or (name in _OF_POINTS and recording.kind in {"wrench", "spot", "flags"}):
            continue
        yield _numbers(case, found, name, [key], [true], allowed)


def _numbers(
    case: Case,
    found: Outcome,
    name: str,
    keys: Sequence[str],
    wanted: Sequence[float | None],
    within: float,
) -> Judged:
    """Judge one figure, of each foot or of the log."""
    values = [found.figure(key) for key in keys]
    known = [
        (value, true)
        for value, true in zip(values, wanted, strict=True)
        if value is not None and true is not None
    ]
    status: Status = "right"
    if not all(abs(value - true) <= within for value, true in known):
        # The impulse is a check: where it fails and that is said, it is no wrong statement.
        is_said = name == "impulse" and case.excuse and found.says("IMPULSE_IS_NOT_WEIGHT")
        status = "null" if is_said else "wrong"
    elif None in values:
        status = _excused(case, name, found)
    return Judged(name, _joined(wanted), _joined(values), status, f"within {within:.3g}")


def _phases(case: Case, recording: Recording, found: Outcome) -> Judged:
    names = recording.robot.feet
    values = [found.figure(f"gait.phase.{name}.mean") for name in names]
    wanted = [each.phase or 0.0 for each in recording.truth.feet]
    known = [(v, w) for v, w in zip(values, wanted, strict=True) if v is not None]
    # Phases may count from another foot than the first.
    turns = np.exp(2j * np.pi * np.array([v - w for v, w in known])) if known else np.ones(1)
    off = np.abs(np.angle(turns / turns[0])) / (2.0 * np.pi)
    status: Status = _right(bool(off.max() <= case.tolerance.phase))
    if status == "right" and None in values:
        status = _excused(case, "phase", found)
    return Judged("phase", _joined(wanted), _joined(values), status)


def _events(case: Case, recording: Recording, found: Outcome) -> Iterator[Judged]:
    for name, key in (("touchdowns", "touchdown_s"), ("lift-offs", "lift_off_s")):
        missed = invented = silent_feet = 0
        errors: list[float] = []
        for foot, truth in zip(recording.robot.feet, recording.truth.feet, strict=True):
            reported = np.array(found.figure(f"feet.{foot}.{key}") or [])
            if not len(reported) and found.figure(f"feet.{foot}.contact_fraction") is None:
                silent_feet += 1
                continue
            true = np.array(getattr(truth, key))
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
