"""Logs of which the poses are at fault, told by feet in three ways; and sound logs beside them."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import cos, radians, sin
from typing import Final

from tests.truth import gaits
from tests.truth import pose_faults as pose
from tests.truth import sensor_faults as sensor
from tests.truth import world_faults as world
from tests.truth.curved import CurvedWalk
from tests.truth.judging import Case
from tests.truth.recorders import FORCE, RATE_HZ
from tests.truth.recording import Disturbance, Recording, disturbed
from tests.truth.robots import biped, quadruped
from tests.truth.walking import Walk

Fault = tuple[str, Walk, tuple[Disturbance, ...], str]
"""What it is called, the walk, what happens to it, and the finding that names it."""
TROT: Final = Walk()
SLOW: Final = Walk(gait=gaits.WALK, period_s=1.2, speed_mps=0.3, seconds=12.0)
CIRCLE: Final = CurvedWalk(gait=gaits.WALK, period_s=1.0, seconds=10.0)
ON_THE_SPOT: Final = CurvedWalk(gait=gaits.WALK, period_s=1.0, seconds=10.0, speed_mps=0.0)
BIPED: Final = Walk(gait=gaits.BIPED_WALK, robot=biped(), period_s=1.1, speed_mps=0.8)
STEPS: Final = Walk(speed_mps=0.0)
UPHILL: Final = Walk(slope_rad=radians(12.0))

WAYS: Final[dict[str, tuple[Disturbance, ...]]] = {
    "contact points": (),
    "forces": (FORCE, sensor.noise(0.5)),
    "places in the base": (pose.feet_in_base,),
    "forces, transforms of the feet": (
        FORCE, sensor.noise(0.5), sensor.in_link_frame, pose.feet_in_tf,
    ),
    "forces, gyroscope": (FORCE, sensor.noise(0.5), pose.with_gyroscope()),
}  # fmt: skip
"""Ways of telling feet, and witnesses of the pose beside them. All but the third have forces."""
FORCES: Final = ("peak force", "braking", "load share", "impulse", "slip", "height", "froude")


def faults() -> Iterator[Case]:
    """Each fault told by feet in each way in which anything tells of it."""
    every = tuple(WAYS)[:3]
    seen = every[0], *tuple(WAYS)[2:4]
    turns = *every, *tuple(WAYS)[3:]
    quarter = radians(30.0)
    table: tuple[tuple[Fault, tuple[str, ...]], ...] = (
        (("frozen", TROT, (pose.frozen(),), "POSE_FROZEN"), every),
        (("frozen, no twist", TROT, (pose.frozen(with_twist=False),), "POSE_FROZEN"), every),
        (("frozen from 4 s on", TROT, (pose.frozen(4.0),), "POSE_FROZEN"), every),
        (("frozen, slow walk", SLOW, (pose.frozen(),), "POSE_FROZEN"), every),
        (("frozen, on the spot in circles", ON_THE_SPOT, (pose.frozen(),), "POSE_FROZEN"), every),
        (("all zero", TROT, (pose.zeros(),), "POSE_FROZEN"), every),
        (("zero quaternions", TROT, (pose.zeros((0.0, 0.0, 0.0, 0.0)),), "NOT_FINITE"), every),
        (("5 Hz repeated at 100 Hz", TROT, (pose.repeated(5.0),), "POSE_REPEATED"), every),
        (("2 Hz repeated at 100 Hz", TROT, (pose.repeated(2.0),), "POSE_REPEATED"), every),
        (("2 Hz", TROT, (pose.rarely(2.0),), "POSE_REPEATED"), every),
        (("millimetres", TROT, (pose.scaled(1000.0),), "POSE_SCALE"), every),
        (("millimetres, twist in m/s", SLOW, (pose.scaled(1e3, with_twist=False),), "POSE_SCALE"),
         every),
        (("feet", TROT, (pose.scaled(3.281),), "POSE_SCALE"), seen),
        (("two thirds of the way", TROT, (pose.scaled(0.66),), "POSE_SCALE"), seen),
        (("positions 30 degrees off", TROT, (pose.positions_turned(quarter),), "POSE_DIRECTION"),
         seen),
        (("yaw 30 degrees off", TROT, (pose.yaw_off(quarter),), "POSE_DIRECTION"), seen),
        (("yaw 15 degrees off, slow walk", SLOW, (pose.yaw_off(radians(-15.0)),),
          "POSE_DIRECTION"), seen),
        (("yaw 28 degrees off, biped", BIPED, (pose.yaw_off(-0.5),), "POSE_DIRECTION"), every[:1]),
        (("another world, circle", CIRCLE, (pose.started_anywhere((1.0, 2.0, 0.0), -2.0),),
          "WORLDS_DIFFER"), every[:1]),
        (("frozen from 2 to 5 s", TROT, (pose.frozen(2.0, until_s=5.0),), "POSE_FROZEN"), every),
        (("orientation constant", CIRCLE, (pose.orientation_constant,), "POSE_ORIENTATION"), turns),
        (("orientation constant, on the spot", ON_THE_SPOT, (pose.orientation_constant,),
          "POSE_FROZEN|POSE_ORIENTATION"), every),
        (("relocalised by 25 degrees", TROT, (pose.relocalised(4.02, radians(25.0)),),
          "POSE_JUMP"), every),
        (("relocalised by 25 degrees and 0.4 m", TROT,
          (pose.relocalised(4.02, radians(25.0), (0.3, -0.25)),), "POSE_JUMP"), every),
        (("yaw steps by 20 degrees", TROT, (pose.yaw_steps(4.02, radians(20.0)),), "POSE_JUMP"),
         every),
        (("poses of the imu's link", ON_THE_SPOT, (pose.of_link((0.25, 0.1, 0.05)),), ""), every),
        (("poses of the imu's link, circle", CIRCLE, (pose.of_link((0.25, 0.1, 0.05)),), ""),
         every),
        (("a quarter of real time, feet without stamps", TROT, (pose.quarter_speed(feet=True),),
          "CLOCK_SPEED"), every),
        (("a quarter of real time, poses without stamps", TROT, (pose.quarter_speed(feet=False),),
          "CLOCK_SPEED"), every),
        (("another robot's poses", TROT, (pose.of_robot("other"),), "POSE_OTHER_ROBOT"),
         every[:2]),
        (("planar poses uphill", UPHILL, (pose.flat,), "POSE_PLANAR"), (*every, *tuple(WAYS)[4:])),
    )  # fmt: skip
    for (name, walk, disturbances, says), ways in table:
        for way in ways:
            yield _case(f"{name}, {way}", walk, way, disturbances, says, says)


def sound() -> Iterator[Case]:
    """Nothing is wrong with these, whatever they look like."""
    ahead, aside = 0.5 * cos(radians(30.0)), -0.5 * sin(radians(30.0))
    straight, turn = quadruped(), radians(30.0)
    corners = tuple(
        (x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn))
        for x, y in straight.corners_m
    )
    crab = Walk(body_yaw_rad=radians(30.0), robot=replace(straight, corners_m=corners))
    starts = pose.started_anywhere((12.0, -7.0, 0.0), radians(70.0))
    run = Walk(gait=gaits.BIPED_RUN, robot=biped(), period_s=0.7, speed_mps=2.5)
    table: tuple[tuple[str, Walk, tuple[Disturbance, ...], tuple[str, ...]], ...] = (
        ("a trot", TROT, (), tuple(WAYS)),
        ("a slow walk", SLOW, (), tuple(WAYS)),
        ("steps on the spot, one pose", STEPS, (), ("contact points", "places in the base")),
        ("a circle", CIRCLE, (), tuple(WAYS)),
        ("a turn on the spot", ON_THE_SPOT, (), tuple(WAYS)),
        ("crabwise", crab, (), tuple(WAYS)),
        ("backwards", Walk(speed_mps=-0.4), (), tuple(WAYS)),
        ("uphill", UPHILL, (), (*tuple(WAYS)[:2], *tuple(WAYS)[3:])),
        ("odometry starts anywhere", TROT, (starts,), ("forces", "places in the base")),
        ("20 Hz odometry", TROT, (pose.rarely(20.0),), tuple(WAYS)),
        (
            "planar poses on level ground",
            TROT,
            (pose.flat,),
            ("forces", "places in the base", "forces, gyroscope"),
        ),
        ("places that are not filled in", TROT, (pose.places_unfilled,), ("places in the base",)),
        ("a run", run, (), ("contact points",)),
        ("noise of 2 mm", TROT, (world.pose_noise(0.002),), tuple(WAYS)),
    )
    for name, walk, disturbances, ways in table:
        for way in ways:
            case = _case(f"sound: {name}, {way}", walk, way, disturbances, "", "")
            if walk is crab:
                case = replace(case, record=_with_truth(case.record, ahead, aside))
            yield case


def _with_truth(
    record: Callable[[], Recording], ahead: float, aside: float
) -> Callable[[], Recording]:
    def change() -> Recording:
        recording = record()
        truth = replace(recording.truth, forward_speed_mps=ahead, lateral_speed_mps=aside)
        return replace(recording, truth=replace(truth, froude=None))

    return change


def _case(
    name: str, walk: Walk, way: str, disturbances: tuple[Disturbance, ...], cause: str, says: str
) -> Case:
    def record() -> Recording:
        recording = disturbed(walk.recorded(RATE_HZ, 100.0), *WAYS[way], *disturbances)
        truth = recording.truth
        feet = [
            replace(each, stride_length_m=abs(each.stride_length_m or 0.0)) for each in truth.feet
        ]
        truth = replace(truth, feet=tuple(feet), path_length_m=abs(truth.path_length_m or 0.0))
        return replace(recording, truth=truth)

    skip = FORCES if way == "places in the base" else ()
    if walk.body_yaw_rad or isinstance(walk, CurvedWalk) or walk.speed_mps <= 0.0:
        skip = (*skip, "braking", *(() if walk.speed_mps else ("froude",)))
    if way.startswith("forces"):
        skip = (*skip, "height", "froude")
    if way in {"forces", "places in the base"} and pose.flat in disturbances:
        # A level pose is all that the log tells.
        cause, skip = "", (*skip, "pitch", "climb", "verdict")
    if way in {"forces", "forces, gyroscope"} and isinstance(walk, CurvedWalk):
        # Strides of a robot that turns are known by where its feet are only.
        cause, skip = cause or "base turns", (*skip, "verdict")
    return Case(name, record, cause, says, skip=(*skip, "energy margin"))
