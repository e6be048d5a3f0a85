"""Logs of feet outside the usual; each right, or null with the cause named."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

from tests.truth import foot_faults as foot
from tests.truth import gaits
from tests.truth import pose_faults as pose
from tests.truth import sensor_faults as sensor
from tests.truth.case import Case
from tests.truth.recording import FLAGS, FORCE, IN_CONTACT, on
from tests.truth.scenes import OneAfterAnother, standing
from tests.truth.walking import Walk
from tests.truth.walks import BIPED, LONG, NO_MASS, QUIET, ROUGH, TROT, WALK, WAVE


# fmt: off
def some() -> Iterator[Case]:
    """Some feet have sensors.

    Some feet have sensors: their own metrics are right, those of all are not known.
    """
    walk = Walk(gait=gaits.WALK, period_s=1.1, shares=(0.3, 0.28, 0.22, 0.2))
    one = foot.without("front_left", "front_right", "back_right")
    of_all = "no other foot|NO_MESSAGES"
    for name, sensors in (("bumpers", ()), ("force sensors", QUIET),
                          ("silent in swing", (IN_CONTACT,))):
        for of, gait in (("trot", TROT), ("walk", walk)):
            yield Case(f"one foot, {of}, {name}", gait, (*sensors, one), of_all)
    yield Case("fore feet, force sensors", walk, (*QUIET, foot.without("back_left", "back_right")),
               of_all)
    yield Case("one foot, mass not given", walk, (one, NO_MASS), of_all, f"{of_all}|mass")
    for name, gait, feet in (
        ("no topic of one foot", TROT, ("back_right",)),
        ("no topics of the fore feet", TROT, ("front_left", "front_right")),
        ("six feet, no topic of a middle one", replace(WAVE, seconds=16.0), ("middle_left",)),
    ):
        yield Case(name, gait, (foot.without(*feet), NO_MASS), "NO_MESSAGES")


def several() -> Iterator[Case]:
    """Several sensors of a foot.

    Each foot has several sensors, told by names or by frames, or by the links of collisions.
    """
    toe_heel = foot.several("/duo/{foot}_foot_heel", "/duo/{foot}_foot_toe")
    cells = foot.several(*(f"/duo/{{foot}}_foot/cell_{n}/force" for n in range(1, 5)))
    quad = foot.several("/quad/{foot}/heel", "/quad/{foot}/toe", reach_m=0.03)
    corners = foot.several("/duo/{foot}_back", "/duo/{foot}_front", share_frames=True)
    for name, walk, faults in (
        ("toe and heel, bumpers", BIPED, (toe_heel,)),
        ("toe and heel, force sensors", BIPED, (*QUIET, toe_heel)),
        ("toe and heel, silent in swing", BIPED, (IN_CONTACT, toe_heel)),
        ("four cells, bumpers", BIPED, (cells,)),
        ("four cells, force sensors", BIPED, (*QUIET, cells)),
        ("toe and heel of four feet, bumpers", WALK, (quad,)),
        ("front and back of each sole, one link, bumpers", BIPED, (corners,)),
        ("front and back of each sole, one frame, force sensors", BIPED, (*QUIET, corners)),
    ):
        yield Case(name, walk, faults, skip="pressure")


def filters() -> Iterator[Case]:
    """Filtered forces.

    Forces that went through a low-pass filter: contact is that of the forces before it.
    """
    slow = Walk(gait=gaits.WALK, period_s=1.3, speed_mps=0.3, seconds=12.0)
    for name, walk, hertz, more in (
        ("5 Hz, trot", TROT, 5.0, sensor.noise(0.5)),
        ("2 Hz, trot", TROT, 2.0, sensor.noise(0.5)),
        ("5 Hz, walk", slow, 5.0, sensor.noise(0.5)),
        ("4 Hz, two feet", BIPED, 4.0, sensor.noise(2.0)),
        ("3 Hz, flat forces", Walk(ramp=0.15, traction=0.0), 3.0, sensor.noise(1.0)),
        ("8 Hz, no noise", WALK, 8.0, sensor.noise(0.0)),
        ("5 Hz, offset -30 N", TROT, 5.0, sensor.offset((0.0, 0.0, -30.0))),
    ):
        yield Case(f"filtered at {name}", walk, (FORCE, foot.filtered(hertz), more),
                   "FORCE_FILTERED", "offset")
    for name, walk in (("trot", TROT), ("two feet", BIPED), ("slow walk", slow), ("walk", WALK)):
        for hertz, newtons in product((0.5, 1.0, 2.5, 12.0), (0.1, 2.0)):
            yield Case(f"filtered at {hertz:g} Hz, {name}, noise {newtons:g} N", walk,
                       (FORCE, foot.filtered(hertz), sensor.noise(newtons)),
                       "FORCE_FILTERED" if hertz < 12.0 else "", "FORCE_FILTERED", ROUGH,
                       "size")


def flags() -> Iterator[Case]:
    """Contact flags.

    Contact without a force.
    """
    hop = Walk(gait=gaits.PRONK, speed_mps=2.0, period_s=0.5)
    flags, turned = FLAGS, foot.inverted()
    slow = Walk(gait=gaits.PRONK, speed_mps=0.3, period_s=0.8)
    gallop = Walk(gait=gaits.ROTARY_GALLOP, speed_mps=2.0, period_s=0.5)
    bound = Walk(gait=gaits.BOUND, speed_mps=0.3, period_s=0.6, heaves=True)
    for name, walk in (("walk", WALK), ("trot", TROT), ("pronk", hop), ("slow pronk", slow),
                       ("slow bound", bound)):
        yield Case(f"flags, {name}", walk, (flags,))
    for rate, walk in ((10.0, TROT), (5.0, WALK)):
        yield Case(f"flags, {rate:g} Hz", walk, (flags, foot.sampled(rate)), "SAMPLED_SLOWLY")
    yield Case("flags, one foot's never set from mid-log on", LONG,
               (flags, on(sensor.dead_from(8.0), "front_left")), "STOPPED", silence_s=(7.2, 99.0))
    for name, walk, faults in (
        ("walk", WALK, (flags, turned)),
        ("trot", TROT, (flags, turned)),
        ("bound", bound, (flags, turned)),
        ("walk, one foot", WALK, (flags, on(turned, "back_left"))),
        ("walk, places in the base", WALK, (pose.feet_in_base, turned)),
        ("fast trot, places in the base", replace(TROT, speed_mps=1.2),
         (pose.feet_in_base, turned)),
    ):
        yield Case(f"inverted flags, {name}", walk, faults, "FLAGS_INVERTED",
                   skip="height" if "fast" in name else "")
    # Feet that gallop are up for most of a stride: turned round, they would walk.
    yield Case("inverted flags, gallop, then stand", OneAfterAnother((gallop, standing())),
               (flags, turned), "FLAGS_INVERTED")


def others() -> Iterator[Case]:
    """Scuffs, payloads, treadmills.

    Scuffs, payloads, moving ground.
    """
    scuff = on(foot.scuffs(12.0, 0.03), "back_left", "back_right")
    for name, sensors in (("bumpers", ()), ("force sensors", QUIET)):
        for of, walk in (("walk", WALK), ("trot", TROT)):
            yield Case(f"hind feet scuff, {of}, {name}", walk, (*sensors, scuff),
                       tolerance=ROUGH, cause="")
    skip = "peak force, size"
    yield Case("a payload put down", TROT, (foot.payload(4.0, 0.75),), "PAYLOAD",
               "PAYLOAD|WEIGHT", skip=skip)
    yield Case("a payload put on, force sensors", WALK,
               (*QUIET, foot.payload(3.0, 1.3), NO_MASS), "PAYLOAD", "PAYLOAD|MASS", ROUGH, skip)
    own = ("class, sequence, touchdowns, lift-offs, contact fraction, duty factor, stride length, "
           "phase, support, load share, peak force, size, braking, pressure")
    for name, sensors in (("bumpers", ()), ("force sensors", QUIET)):
        yield Case(f"one foot held up for six strides, {name}", replace(WALK, seconds=16.0),
                   (foot.held_up("back_left", 5.0, 11.2), *sensors), "", skip=own)
    yield Case("one foot held up throughout", WALK, (foot.held_up("back_left", -1.0, 99.0),),
               "back_left never touches the ground, and the other feet carry",
               skip=f"{own}, verdict")
    yield Case("a contact point goes 0.4 m", TROT, (foot.slip("front_left", 3.3, 0.4),),
               "SLIPS", "")
    for name, walk in (("trot", TROT), ("walk", WALK)):
        yield Case(f"treadmill, {name}, contact points", walk, (foot.treadmill,), "TREADMILL", "",
                   skip="slip, largest slip")
        yield Case(f"treadmill, {name}, places in the base", walk,
                   (pose.feet_in_base, foot.treadmill), "TREADMILL", "")
    for slope_rad in (0.1, -0.2):
        yield Case(f"treadmill that leans by {slope_rad} rad", Walk(slope_rad=slope_rad),
                   (foot.treadmill,), "TREADMILL", skip="verdict")
# fmt: on
