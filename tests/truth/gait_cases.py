"""Logs of sound sensors: robots, rates, gaits."""

from collections.abc import Iterator
from math import radians

from tests.truth import gaits
from tests.truth import sensor_faults as sensor
from tests.truth.case import Case
from tests.truth.gaits import Gait
from tests.truth.recording import FORCE, Disturbance, changed
from tests.truth.robots import biped, hexapod, quadruped
from tests.truth.walking import Walk
from tests.truth.walks import ROUGH, SENSED, TROT

KINDS: tuple[tuple[str, tuple[Disturbance, ...]], ...] = (
    ("bumpers", ()),
    ("force sensors", (FORCE,)),
)
NOISY = KINDS[0], ("force sensors", SENSED)


# fmt: off
def robots_and_rates() -> Iterator[Case]:
    """Robots and sampling rates."""
    for mass in (0.5, 2.0, 20.0, 80.0):
        for kind, sensors in KINDS:
            yield Case(f"trot, {kind}, {mass:g} kg", Walk(robot=quadruped(mass)), sensors)
    yield Case("trot, the left feet carry more", Walk(shares=(0.3, 0.2, 0.3, 0.2)))
    yield Case("trot, feet slip by 30 mm", Walk(slip_m=0.03), cause="slip")
    yield Case("trot, feet slip by 30 mm and hardly roll", Walk(slip_m=0.03),
               (sensor.user_gives(set={"foot_rolling_m": "1e-6"}),))
    yield Case("trot, bumpers touch the robot itself", TROT, (changed(touches_itself=True),))
    yield Case("trot, contacts without forces", TROT, (sensor.without_forces(),),
               "NO_FORCE|no force|zero", skip="verdict")
    yield Case("trot, 1 % of the forces no numbers", TROT, (sensor.not_finite(0.01),), "FINITE")
    for degrees in (-90, 90, 180):
        yield Case(f"trot, forward is {degrees:+d} degrees off the base's x",
                   Walk(body_yaw_rad=radians(degrees)), (), "FORWARD_AXIS|forward axis|sideways")
    for rate in (20.0, 50.0, 1000.0):
        walk = Walk(seconds=3.5 if rate > 500.0 else 12.0)
        for kind, sensors in KINDS:
            yield Case(f"trot, {kind}, {rate:g} Hz", walk, sensors, rate_hz=rate)


def hildebrand() -> Iterator[Case]:
    """Symmetrical gaits: Hildebrand's grid."""
    for duty in (0.42, 0.55, 0.7, 0.8):
        for diagonality in (0.0, 0.25, 0.5, 0.75):
            gait = gaits.symmetrical(duty, diagonality)
            yield from _gait_and_mirror(f"duty {duty:g}, diagonality {diagonality:g}", gait)
    for diagonality in (0.1, 0.4):
        border = Walk(gait=gaits.symmetrical(0.62, diagonality), period_s=0.7, seconds=16.0)
        yield Case(f"noise at the border of two classes, diagonality {diagonality:g}", border,
                   (FORCE, sensor.noise(6.0)), "", "offset", ROUGH, "class, size", rate_hz=100.0,
                   events=())


def asymmetrical() -> Iterator[Case]:
    """Asymmetrical gaits."""
    for gait in gaits.ASYMMETRICAL:
        name = f"{gait.sequence or ''} {gait.name}".strip()
        yield from _gait_and_mirror(name, gait)
        yield Case(f"{name} from mid-cycle", _brisk(gait.advanced(0.4)))


def _gait_and_mirror(name: str, gait: Gait) -> Iterator[Case]:
    yield Case(name, _brisk(gait))
    yield Case(f"{name}, mirrored", _brisk(gait.mirrored()))


def _brisk(gait: Gait) -> Walk:
    return Walk(gait=gait, seconds=4.8, period_s=0.6, speed_mps=0.8)


def other_numbers_of_feet() -> Iterator[Case]:
    """Two and six feet."""
    for gait in (gaits.BIPED_WALK, gaits.BIPED_RUN, gaits.BIPED_HOP):
        yield Case(f"two feet, {gait.name}", Walk(gait=gait, robot=biped()))
    for gait in (gaits.TRIPOD, gaits.TETRAPOD, gaits.WAVE):
        walk = Walk(gait=gait, robot=hexapod(), period_s=1.0, speed_mps=0.1)
        yield Case(f"six feet, {gait.name}", walk)


def short_and_slow() -> Iterator[Case]:
    """Short logs and slow ones."""
    for kind, sensors in NOISY:
        for strides in (2, 3):
            yield Case(f"{strides} strides, {kind}", Walk(seconds=strides * 0.8 + 0.3), sensors,
                       cause=r"stride|stance|longer|short")
        yield Case(f"1.3 strides, {kind}", Walk(seconds=1.04), sensors, cause="stride")
    crawl = Walk(gait=gaits.WALK, period_s=8.0, speed_mps=0.03, seconds=60.0)
    for kind, sensors in KINDS:
        yield Case(f"crawl, 8 s a stride, {kind}", crawl, sensors,
                   tolerance=ROUGH, rate_hz=50.0)
# fmt: on
