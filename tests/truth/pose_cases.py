"""Logs of poses at fault, with several witnesses, of worlds that differ, and sound ones."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import cos, radians, sin
from typing import Final

from tests.truth import gaits
from tests.truth import pose_faults as pose
from tests.truth import sensor_faults as sensor
from tests.truth import time_faults as time
from tests.truth.case import Case
from tests.truth.foot_faults import without
from tests.truth.recording import FORCE, Disturbance, changed, together, true
from tests.truth.robots import biped, hexapod, quadruped
from tests.truth.sensed import with_imu
from tests.truth.walking import Walk
from tests.truth.walks import BIPED, LONG, NO_MASS, QUIET, ROUGH, SLOW, TROT, WALK

CIRCLE: Final = Walk(gait=gaits.WALK, period_s=1.0, seconds=10.0, turn_radps=0.4)
TIGHT: Final = Walk(gait=gaits.TRIPOD, robot=hexapod(3.0), period_s=0.9, speed_mps=0.1,
                    step_height_m=0.02, turn_radps=-0.3)  # fmt: skip
ON_THE_SPOT: Final = replace(CIRCLE, speed_mps=0.0)
TO_THE_RIGHT: Final = Walk(period_s=0.7, seconds=9.0, turn_radps=-0.5)
FAST: Final = Walk(gait=gaits.symmetrical(0.42, 0.5), period_s=0.6, speed_mps=1.2)
DOWNHILL: Final = Walk(gait=gaits.WALK, period_s=1.1, speed_mps=0.35, slope_rad=radians(-9.0))
UPHILL: Final = Walk(slope_rad=radians(12.0))

POINTS: Final = "contact points"
FORCES: Final = "forces"
PLACES: Final = "places in the base"
TF: Final = "forces, transforms of the feet"
GYRO: Final = "forces, gyroscope"
WAYS: Final[dict[str, tuple[Disturbance, ...]]] = {
    POINTS: (),
    FORCES: QUIET,
    PLACES: (pose.feet_in_base,),
    TF: (*QUIET, sensor.in_link_frame, pose.feet_in_tf),
    GYRO: (*QUIET, with_imu(noise_mps2=0.02, gyroscope=True)),
}
"""Ways of telling feet, and witnesses of the pose beside them."""
EVERY: Final = tuple(WAYS)[:3]
SEEN: Final = POINTS, PLACES, TF
"""Those that tell how the base moves."""


# fmt: off
def faults() -> Iterator[Case]:
    """Poses at fault.

    Each fault told by feet in each way in which anything tells of it.
    """
    quarter, link = radians(30.0), pose.of_link((0.25, 0.1, 0.05))
    still, turned = "POSE_FROZEN", "POSE_DIRECTION"
    table: tuple[tuple[str, Walk, Disturbance, str, Sequence[str]], ...] = (
        ("frozen", TROT, pose.frozen(), still, (*EVERY, TF)),
        ("frozen, no twist", TROT, pose.frozen(with_twist=False), still, EVERY),
        ("frozen from 4 s on", TROT, pose.frozen(4.0), still, EVERY),
        ("frozen from 2 to 5 s", TROT, pose.frozen(2.0, until_s=5.0), still, EVERY),
        ("frozen, slow walk", SLOW, pose.frozen(), still, EVERY),
        ("frozen, two feet to the left", replace(BIPED, turn_radps=0.15), pose.frozen(), still,
         (POINTS,)),
        ("frozen, on the spot in circles", ON_THE_SPOT, pose.frozen(), still, EVERY),
        ("all zero", TROT, pose.zeros(), still, EVERY),
        ("zero quaternions", TROT, pose.zeros((0.0, 0.0, 0.0, 0.0)), "NOT_FINITE", EVERY),
        ("5 Hz repeated at 100 Hz", TROT, pose.repeated(5.0), "POSE_REPEATED", EVERY),
        ("2 Hz repeated at 100 Hz", TROT, pose.repeated(2.0), "POSE_REPEATED", EVERY),
        ("2 Hz", TROT, pose.rarely(2.0), "POSE_REPEATED", EVERY),
        ("millimetres", TROT, pose.scaled(1000.0), "POSE_SCALE", (*EVERY, TF)),
        ("millimetres, twist in m/s", SLOW, pose.scaled(1e3, with_twist=False), "POSE_SCALE",
         EVERY),
        ("feet", TROT, pose.scaled(3.281), "POSE_SCALE", SEEN),
        ("two thirds of the way", TROT, pose.scaled(0.66), "POSE_SCALE", SEEN),
        ("positions 30 degrees off", TROT, pose.positions_turned(quarter), "POSE_DIRECTION", SEEN),
        ("yaw 30 degrees off", TROT, pose.yaw_off(quarter), "POSE_DIRECTION", SEEN),
        ("yaw 30 degrees off, uphill", UPHILL, pose.yaw_off(quarter), "POSE_DIRECTION", SEEN),
        ("yaw 180 degrees off, walk", WALK, pose.yaw_off(radians(180.0)), "POSE_DIRECTION",
         (PLACES,)),
        ("yaw 180 degrees off, fast trot", FAST, pose.yaw_off(radians(180.0)), "POSE_DIRECTION",
         (PLACES,)),
        ("yaw 15 degrees off, slow walk", SLOW, pose.yaw_off(radians(-15.0)), "POSE_DIRECTION",
         SEEN),
        ("yaw 28 degrees off, biped", BIPED, pose.yaw_off(-0.5), "POSE_DIRECTION", (POINTS,)),
        ("another world, circle", CIRCLE, pose.relocalised(0.0, -2.0, (1.0, 2.0, 0.0)),
         "WORLDS_DIFFER", (POINTS,)),
        ("orientation constant", CIRCLE, pose.orientation_constant(), turned, tuple(WAYS)),
        ("orientation constant, to the right", TO_THE_RIGHT, pose.orientation_constant(), turned,
         (TF, GYRO)),
        ("orientation constant, on the spot", ON_THE_SPOT, pose.orientation_constant(),
         f"{still}|{turned}", EVERY),
        ("relocalised by 25 degrees", TROT, pose.relocalised(4.02, radians(25.0)), "POSE_JUMP",
         EVERY),
        ("relocalised by 25 degrees and 0.4 m", TROT,
         pose.relocalised(4.02, radians(25.0), (0.3, -0.25, 0.0)), "POSE_JUMP", EVERY),
        ("yaw steps by 20 degrees", TROT, pose.yaw_off(radians(20.0), 4.02), "POSE_JUMP", EVERY),
        ("yaw off by 45 degrees, tight circle", TIGHT, pose.yaw_off(radians(45.0)),
         "POSE_DIRECTION", (POINTS,)),
        ("poses of the imu's link", ON_THE_SPOT, link, "", EVERY),
        ("poses of the imu's link, circle", CIRCLE, link, "", EVERY),
        ("millimetres, as the user says", TROT,
         together(pose.scaled(1e3), sensor.user_gives(set={"odometry_scale": "0.001"})), "",
         (POINTS,)),
        ("centre of mass beside the base", TROT,
         together(pose.of_link((0.04, 0.03, 0.0), "trunk"), changed(statics=()),
                  sensor.user_gives(set={"com_offset_m": "-0.04,-0.03,0"}),
                  true(pressure_forward_m=None, pressure_left_m=None)), "", (POINTS,)),
        ("poses of the shell, base named", ON_THE_SPOT,
         together(pose.of_link((0.25, 0.1, 0.05), "shell"),
                  sensor.user_gives(set={"base_frame": "base_link"})), "", (POINTS,)),
        ("poses of a link that is nowhere", TROT,
         together(pose.of_link((0.05, 0.02, 0.01)), changed(statics=())),
         "POSE_FRAME .* no static transform", (POINTS,)),
        ("a quarter of real time, feet without stamps", TROT,
         time.stamped_in_part(feet=True, slower=4.0), "CLOCK_OFFSET", EVERY),
        ("a quarter of real time, poses without stamps", TROT,
         time.stamped_in_part(feet=False, slower=4.0), "CLOCK_OFFSET", EVERY),
        ("another robot's poses", TROT, pose.of_robot("other"), "POSE_OTHER_ROBOT", EVERY[:2]),
        ("rises by 4 cm/s", TROT, pose.rising(0.04), "WORLDS_DIFFER the base rises", (PLACES, TF)),
        ("sinks by 4 cm/s uphill", UPHILL, pose.rising(-0.04), "WORLDS_DIFFER the base rises by -",
         (PLACES, TF)),
        ("planar poses uphill", UPHILL, pose.flat(), "POSE_PLANAR", (POINTS, GYRO)),
        ("planar poses on a slope, on the spot", replace(UPHILL, speed_mps=0.0), pose.flat(),
         "POSE_PLANAR .* the feet's plane leans", (POINTS,)),
        ("planar poses downhill", DOWNHILL, pose.flat(), "POSE_PLANAR", (POINTS, GYRO)),
    )
    for name, walk, fault, says, ways in table:
        for way in ways:
            yield _case(f"{name}, {way}", walk, way, fault, says)
    for way in (FORCES, PLACES):
        # A level pose is all that the log tells.
        case = _case(f"planar poses uphill, {way}", UPHILL, way, pose.flat(), "POSE_PLANAR")
        yield replace(case, cause="", skip="pitch, climb, slope, height, verdict")


def sound() -> Iterator[Case]:
    """Sound poses."""
    turn = radians(30.0)
    corners = tuple((x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn))
                    for x, y in quadruped().corners_m)
    crabwise = true(forward_speed_mps=0.5 * cos(turn), lateral_speed_mps=-0.5 * sin(turn),
                    froude=None, braking_impulse_ns=None, propulsive_impulse_ns=None)
    crab = Walk(body_yaw_rad=turn, robot=replace(quadruped(), corners_m=corners))
    starts = pose.relocalised(0.0, radians(70.0), (12.0, -7.0, 0.0))
    run = Walk(gait=gaits.BIPED_RUN, robot=biped(), period_s=0.7, speed_mps=2.5)
    gallop = Walk(gait=gaits.ROTARY_GALLOP, robot=quadruped(1.0), period_s=0.58, speed_mps=0.34)
    sagging = Walk(gait=replace(gaits.PACE, duty=0.8), hump=-0.1)
    few = Walk(gait=gaits.TRIPOD, robot=hexapod(10.0), period_s=0.7, speed_mps=0.1, seconds=4.0)
    heaving = Walk(gait=gaits.TRIPOD, robot=hexapod(3.0), period_s=0.82, speed_mps=0.6, seconds=7.3,
                   heaves=True)
    bounding = Walk(gait=gaits.HALF_BOUND, speed_mps=0.2, turn_radps=-0.8, seconds=12.0)
    every, nothing = tuple(WAYS), together()
    table: tuple[tuple[str, Walk, Disturbance, Sequence[str]], ...] = (
        ("a trot", TROT, nothing, every),
        ("a slow walk", SLOW, nothing, every),
        ("steps on the spot, one pose", Walk(speed_mps=0.0), nothing, (POINTS, PLACES)),
        ("a circle", CIRCLE, nothing, every),
        ("a turn on the spot", ON_THE_SPOT, nothing, every),
        ("a tight circle", TIGHT, nothing, (POINTS,)),
        ("crabwise", crab, crabwise, every),
        ("backwards", Walk(speed_mps=-0.4), nothing, every),
        ("uphill", UPHILL, nothing, (POINTS, FORCES, TF, GYRO)),
        ("odometry starts anywhere", TROT, starts, (FORCES, PLACES, TF)),
        ("20 Hz odometry", TROT, pose.rarely(20.0), every),
        ("planar poses on level ground", TROT, pose.flat(), (FORCES, PLACES, GYRO)),
        ("places that are not filled in", TROT, pose.places_unfilled, (PLACES,)),
        ("a few strides", few, nothing, (FORCES,)),
        ("a tight circle on one hind foot at times", bounding, nothing, (POINTS, PLACES)),
        ("a run", run, nothing, (POINTS,)),
        ("a slow gallop", gallop, nothing, (POINTS, PLACES)),
        ("noise of 2 mm", TROT, pose.pose_noise(0.002), every),
        ("noise of 10 mm, tight circle", Walk(turn_radps=1.2, seconds=10.0), pose.pose_noise(0.01),
         (POINTS,)),
    )
    for name, walk, fault, ways in table:
        for way in ways:
            yield _case(f"sound: {name}, {way}", walk, way, fault, "")
    faults = (pose.feet_in_tf, sensor.in_link_frame)
    yield Case("sound: loads that sag in mid-stance", sagging, faults, "")
    case = _case(f"sound: few strides that heave, {TF}", heaving, TF, nothing, "")
    yield replace(case, skip="peak force, size, braking", tolerance=ROUGH)
# fmt: on


def _case(name: str, walk: Walk, way: str, fault: Disturbance, says: str) -> Case:
    # Strides of a robot that turns are known by where its feet are only.
    turns = way in {FORCES, GYRO} and walk.turn_radps
    cause = says or ("base turns" if turns else "")
    # Feet that tell where they are stand in for poses.
    stand_in = way in {POINTS, PLACES} and says in {"POSE_FROZEN", "NOT_FINITE"}
    known = "speed" if stand_in else ""
    return Case(name, walk, (*WAYS[way], fault), says, cause, known=known)


WORLDS = r"WORLD|worlds|drift|far from"


# fmt: off
def worlds() -> Iterator[Case]:
    """Worlds."""
    drift = pose.drifting(0.02)
    bound = Walk(gait=gaits.BOUND, period_s=0.86, seconds=11.7, heading_rad=radians(-90.0))
    slope = Walk(slope_rad=radians(20.0), heading_rad=radians(37.0), seconds=12.0)
    two = Walk(gait=gaits.BIPED_WALK, robot=biped(57.0), slope_rad=radians(14))
    rows: tuple[tuple[str, Walk, tuple[Disturbance, ...], str], ...] = (
        ("drifts by 8 %", LONG, (pose.drifting(0.08),), WORLDS),
        ("drifts by 2 %, 4 s", replace(TROT, seconds=4.0), (drift,), WORLDS),
        ("drifts by 2 %, 8 s", TROT, (drift,), WORLDS),
        ("underrates the way by 15 %", bound, (pose.drifting(0.15),), "WORLDS_DIFFER|drifts"),
        ("begins at z = 0", TROT, (pose.from_zero(),), ""),
        ("begins at z = 0, force sensors", TROT, (FORCE, pose.from_zero()), ""),
        ("begins at z = 0, slope of 14 degrees, two feet", two, (pose.from_zero(),), ""),
        ("with 2 mm of noise", TROT, (pose.pose_noise(0.002),), ""),
        ("jumps by 1 m", TROT, (pose.jump(4.0, (1.0, 0.5, 0.0)),), "jump"),
        ("jumps by 1 m, slope of 20 degrees", slope, (pose.jump(6.0, (1.0, 0.5, 0.0)),), "jump"),
    )
    # Lengths of feet with points of their own stay.
    yield Case("odometry displaced by 5 m", TROT, (pose.jump(0.0, (3.0, 4.0, 0.0)),), WORLDS,
               known="stride length")
    yield Case("odometry displaced by 5 m and turned by 45 degrees", TROT,
               (pose.relocalised(0.0, radians(45.0), (3.0, 4.0, 0.0)),), WORLDS)
    yield Case("odometry displaced by 2 m, points of the hind feet only", TROT,
               (pose.jump(0.0, (1.2, 1.6, 0.0)), without("front_left", "front_right"), NO_MASS),
               "WORLDS_DIFFER", f"{WORLDS}|NO_MESSAGES")
    for name, walk, faults, says in rows:
        yield Case(f"odometry {name}", walk, faults, says)
    yield Case("contact points drift by 8 %", LONG, (pose.points_drifting(0.08),), WORLDS)
    yield Case("the body leans 4 cm to the side from 3 s on", TROT,
               (pose.leaning(3.0, (0.0, 0.04, 0.0)),), skip="margin, energy margin, pressure")


def axes() -> Iterator[Case]:
    """Other axes."""
    for name, body in (("", False), (" and of its body", True)):
        yield Case(f"motion capture, y up of the world{name}", Walk(heading_rad=radians(90.0)),
                   (pose.y_up(body=body), FORCE), "UP_AXIS")
    yield Case("all in a world with z down and y to the right", WALK, (pose.z_down, NO_MASS),
               "SIDES_SWAPPED", "SIDES_SWAPPED|IMPULSE")
    yield Case("topics of the fore feet swapped", WALK,
               (pose.swapped("front_left", "front_right"),), "SIDES_SWAPPED",
               skip="touchdowns, lift-offs, phase")
    for speed in (0.02, -0.02, -0.1):
        yield Case(f"odometry drifts by {speed:+g} m/s in z", Walk(seconds=12.0),
                   (pose.rising(speed),), "WORLDS_DIFFER the base (rises|sinks)")
    yield Case("odometry counts z anew from mid-log on", Walk(seconds=12.0),
               (pose.jump(6.0, (0.0, 0.0, -0.45)),), "POSE_JUMP", "", known="height")
# fmt: on
