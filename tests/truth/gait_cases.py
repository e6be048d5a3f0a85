"""Logs of sound sensors: robots, rates, gaits."""

from collections.abc import Iterator
from math import radians

from tests.truth import gaits
from tests.truth import sensor_faults as sensor
from tests.truth.gaits import Gait
from tests.truth.judging import Case, Tolerance
from tests.truth.recorders import FORCE, recorder
from tests.truth.robots import biped, hexapod, quadruped
from tests.truth.walking import Walk


def robots_and_rates() -> Iterator[Case]:
    for mass in (0.5, 2.0, 20.0, 80.0):
        walk = Walk(robot=quadruped(mass))
        yield Case(f"trot, bumpers, {mass:g} kg", recorder(walk))
        yield Case(f"trot, force sensors, {mass:g} kg", recorder(walk, FORCE))
    uneven = Walk(shares=(0.3, 0.2, 0.3, 0.2))
    yield Case("trot, the left feet carry more", recorder(uneven), skip=("peak force", "braking"))
    yield Case("trot, feet slip by 30 mm", recorder(Walk(slip_m=0.03)), "slip", skip=("verdict",))
    yield Case("trot, bumpers touch the robot itself", recorder(Walk(), sensor.touching_itself))
    none = "NO_FORCE|no force|zero"
    yield Case(
        "trot, contacts without forces",
        recorder(Walk(), sensor.without_forces),
        none,
        none,
        skip=("verdict",),
    )
    yield Case(
        "trot, 1 % of the forces no numbers",
        recorder(Walk(), sensor.not_finite(0.01)),
        "FINITE",
        "FINITE",
    )
    axis = "FORWARD_AXIS|forward axis|sideways"
    for degrees in (-90, 90, 180):
        yield Case(
            f"trot, forward is {degrees:+d} degrees off the base's x",
            recorder(Walk(body_yaw_rad=radians(degrees))),
            axis,
            axis,
        )
    for rate in (20.0, 50.0, 1000.0):
        coarse = 1.6 / rate
        allow = Tolerance(
            event_s=max(0.03, coarse), duty=max(0.03, coarse / 0.8), force=0.05 + 0.6 / rate
        )
        seconds = 3.5 if rate > 500.0 else 12.0
        walk = Walk(seconds=seconds)
        yield Case(f"trot, bumpers, {rate:g} Hz", recorder(walk, rate_hz=rate), tolerance=allow)
        yield Case(
            f"trot, force sensors, {rate:g} Hz",
            recorder(walk, FORCE, rate_hz=rate),
            tolerance=allow,
        )


def hildebrand() -> Iterator[Case]:
    for duty in (0.42, 0.55, 0.7, 0.8):
        for diagonality in (0.0, 0.25, 0.5, 0.75):
            gait = gaits.symmetrical(duty, diagonality)
            yield from _gait_and_mirror(f"duty {duty:g}, diagonality {diagonality:g}", gait)


def asymmetrical() -> Iterator[Case]:
    for gait in gaits.ASYMMETRICAL:
        yield from _gait_and_mirror(f"{gait.sequence or ''} {gait.name}".strip(), gait)
        yield Case(
            f"{gait.sequence or ''} {gait.name} from mid-cycle".strip(),
            recorder(_brisk(gait.advanced(0.4))),
        )


def _gait_and_mirror(name: str, gait: Gait) -> Iterator[Case]:
    yield Case(name, recorder(_brisk(gait)))
    yield Case(f"{name}, mirrored", recorder(_brisk(gait.mirrored())))


def _brisk(gait: Gait) -> Walk:
    return Walk(gait=gait, seconds=4.8, period_s=0.6, speed_mps=0.8)


def other_numbers_of_feet() -> Iterator[Case]:
    for gait in (gaits.BIPED_WALK, gaits.BIPED_RUN, gaits.BIPED_HOP):
        yield Case(f"two feet, {gait.name}", recorder(Walk(gait=gait, robot=biped())))
    for gait in (gaits.TRIPOD, gaits.TETRAPOD, gaits.WAVE):
        walk = Walk(gait=gait, robot=hexapod(), period_s=1.0, speed_mps=0.1)
        # A twentieth of the weight is much of what one of five feet carries.
        allow = Tolerance(event_s=0.05, duty=0.05, contact=0.05)
        yield Case(f"six feet, {gait.name}", recorder(walk), tolerance=allow)


def short_and_slow() -> Iterator[Case]:
    for strides in (2, 3):
        walk = Walk(seconds=strides * 0.8 + 0.3)
        for kind, more in (("bumpers", ()), ("force sensors", (FORCE, sensor.noise(1.0)))):
            yield Case(
                f"{strides} strides, {kind}", recorder(walk, *more), r"stride|stance|longer|short"
            )
    for kind, more in (("bumpers", ()), ("force sensors", (FORCE, sensor.noise(1.0)))):
        walk = Walk(seconds=1.04)
        yield Case(f"1.3 strides, {kind}", recorder(walk, *more), "stride", skip=("impulse",))
    crawl = Walk(gait=gaits.WALK, period_s=8.0, speed_mps=0.03, seconds=60.0)
    slow = Tolerance(event_s=0.15)
    yield Case("crawl, 8 s a stride, bumpers", recorder(crawl, rate_hz=50.0), tolerance=slow)
    yield Case(
        "crawl, 8 s a stride, force sensors", recorder(crawl, FORCE, rate_hz=50.0), tolerance=slow
    )
