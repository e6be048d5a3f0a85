"""What `stats` says of the whole robot: a line a subject."""

import math
from collections.abc import Callable, Mapping
from typing import Final

from dogbot_logtool.core.arrays import Aggregate
from dogbot_logtool.core.metrics import WalkMetrics
from dogbot_logtool.core.records import METRICS
from dogbot_logtool.report.tables import decimal, why_null

_GRAVITY: Final = 9.80665
"""m/s^2."""


def _support(metrics: WalkMetrics) -> str:
    shares = {int(number): share for number, share in (metrics.gait.support or {}).items()}
    words = [
        f"{number} {'foot' if number == 1 else 'feet'} {share:.0%}"
        for number, share in shares.items()
        if share >= 0.005
    ]
    if words:
        return f"{', '.join(words)} of the time"
    why = why_null(metrics, METRICS.gait.support)
    return f"not known: {why}" if metrics.feet and metrics.gait.support is None else ""


def _stability(metrics: WalkMetrics) -> str:
    stability = metrics.stability
    margin = stability.static_margin_m
    if margin is None:
        return ""
    defined = 1.0 - (stability.unknown_fraction or 0.0) - (stability.undefined_fraction or 0.0)
    when = f"; defined {defined:.0%} of the time" if defined < 0.995 else ""
    median, least = (f"{value * 1e3:.0f} mm" for value in (margin.median, margin.min))
    return f"static margin {median} (median), min {least}{when}"


def _load_check(metrics: WalkMetrics) -> str:
    settings, ratio = metrics.settings, metrics.forces.vertical_impulse_over_weight
    if ratio is not None:
        of = "" if settings.mass_kg is None else f" ({settings.mass_kg:.1f} kg)"
        return f"the feet carry {ratio:.1%} of the body weight{of}"
    if all(foot.peak_force_n is None for foot in metrics.feet.values()):
        return ""
    words = why_null(metrics, METRICS.forces.vertical_impulse_over_weight)
    if weight := settings.body_weight_n:
        words += f"; the feet carry {weight:.0f} N ({weight / _GRAVITY:.1f} kg) on average"
    return f"not made: {words}"


def _base(metrics: WalkMetrics) -> str:
    base = metrics.base
    if base.path_length_m is None:
        return f"not measured: {why_null(metrics, METRICS.base.path_length_m)}"
    turn = math.degrees(base.yaw_change_rad or 0.0)
    parts = (
        f"{base.path_length_m:.2f} m travelled",
        f"turned {turn:.0f} deg" if abs(turn) > 3.0 else "",
        f"height {base.height_m.median:.3f} m" if base.height_m else "",
        _angle("roll", base.roll_rad),
        _angle("pitch", base.pitch_rad),
    )
    legs = " (estimated: by the legs)" if metrics.settings.base_from == "legs" else ""
    return ", ".join(filter(None, parts)) + legs


def _angle(name: str, angle: Aggregate | None) -> str:
    if angle is None:
        return ""
    spread = "" if angle.std is None else f" (sd {math.degrees(angle.std):.1f})"
    return f"{name} {math.degrees(angle.median):z.1f} deg{spread}"


def _energy(metrics: WalkMetrics) -> str:
    work, cost = metrics.legs.absolute_work_j, metrics.legs.mechanical_cost_of_transport
    parts = (
        "" if work is None else f"{work.median:.1f} J of joint work a stride",
        "" if cost is None else f"mechanical cost of transport {cost:.2f}",
    )
    return ", ".join(filter(None, parts))


def _commands(metrics: WalkMetrics) -> str:
    commands = metrics.commands
    errors = (
        (commands.forward.rms_error_mps, "m/s forward"),
        (commands.lateral.rms_error_mps, "m/s sideways"),
        (commands.yaw.rms_error_radps, "rad/s"),
    )
    known = [f"{error:.2f} {unit}" for error, unit in errors if error is not None]
    return f"{commands.topic}: RMS error {', '.join(known)}" if known else ""


def _accelerometer(metrics: WalkMetrics) -> str:
    imu = metrics.imu
    read, tilt, ratio = imu.accelerometer_mps2, imu.tilt_rad, imu.forces_over_accelerometer
    parts = (
        "" if read is None else f"{decimal(read, 2)} m/s^2 over strides",
        "" if tilt is None else f"tilt {math.degrees(tilt):.1f} deg",
        "" if ratio is None else f"the forces are {ratio:.1%} of mass x acceleration",
    )
    known = ", ".join(filter(None, parts))
    return f"{imu.topic}: {known}" if known else ""


def _events(metrics: WalkMetrics) -> str:
    times: dict[str, list[float]] = {}
    for each in metrics.events:
        times.setdefault(each.type.replace("_", " "), []).append(each.onset_s)
    kinds = [
        f"{kind} at {at[0]:.1f} s"
        if len(at) == 1
        else f"{len(at)} x {kind}, first at {at[0]:.1f} s"
        for kind, at in times.items()
    ]
    what = ", ".join(kinds) or "none"
    feet = metrics.feet.values()
    steps = sum(len(foot.touchdown_s or ()) + len(foot.lift_off_s or ()) for foot in feet)
    return f"{what}; {steps} touchdowns and lift-offs (export --table events)" if steps else what


SUBJECTS: Final[Mapping[str, Callable[[WalkMetrics], str]]] = {
    "Support": _support,
    "Stability": _stability,
    "Load check": _load_check,
    "Base": _base,
    "Energy": _energy,
    "Commands": _commands,
    "Accelerometer": _accelerometer,
    "Events": _events,
}
"""By name what says it; nothing where it is not known."""
