"""Logs in which something happens beside steps, or in which there are none."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from math import radians
from typing import Final

import numpy as np

from tests.truth import foot_faults as foot
from tests.truth import pose_faults as pose
from tests.truth import scenes
from tests.truth import sensor_faults as sensor
from tests.truth import time_faults as time
from tests.truth.case import Case, Event
from tests.truth.recording import FORCE, Disturbance, on
from tests.truth.scenes import Knots, OneAfterAnother, Scene
from tests.truth.walking import Walk
from tests.truth.walks import QUIET, SENSED, WALK

FOOT: Final = "front_right"
TROT: Final = Walk(seconds=12.0)
LEAVES: Final = float(TROT.lift_offs(1)[6])
LANDS: Final = float(TROT.touchdowns(1)[TROT.touchdowns(1) > LEAVES][0])
EARLY: Final = LEAVES + 0.4 * (LANDS - LEAVES)


# fmt: off
def planned() -> Iterator[Case]:
    """Events."""
    slides = LANDS + 0.25
    jump, hush = pose.jump(4.0, (1.0, 0.5, 0.0)), on(time.silent_between(3.0, 5.0), "back_left")
    early = Event("early_contact", EARLY, foot=FOOT, value=(LANDS - EARLY, 0.02))
    jumps = Event("pose_jump", 4.0, code="POSE_JUMP", value=(1.25**0.5, 0.01))
    silent = Event("gap", 3.0, foot="back_left", value=(2.0, 0.012))
    steps = "touchdowns, lift-offs, stride length"
    rows: list[tuple[str, Disturbance, str, str, tuple[Event, ...]]] = [
        ("a foot lands early and stays", foot.contact(FOOT, EARLY), "", "touchdowns, margin",
         (early,)),
        ("a foot bounces as it leaves", foot.contact(FOOT, LEAVES + 0.03, LEAVES + 0.06), "",
         steps, ()),
        ("a foot bounces as it lands", foot.contact(FOOT, LANDS - 0.06, LANDS - 0.03), "",
         steps, ()),
        ("poses with 2 mm of noise", pose.pose_noise(0.002), "", "", ()),
        ("poses with 10 mm of noise", pose.pose_noise(0.01), "", "", ()),
        ("contact points roll forward", foot.rolling(0.06), "", "", ()),
        ("one jump of the pose", jump, "POSE_JUMP", "", (jumps,)),
        ("one gap of a foot", hush, "GAPS", "", (silent,)),
    ]
    for metres, rolling_m in product((0.01, 0.05), (None, "0.005", "0.01")):
        slip = Event("slip", slides, foot=FOOT, duration_s=0.04, value=(metres, 1e-6))
        known = sensor.user_gives(set={"foot_rolling_m": rolling_m} if rolling_m else {})
        yield Case(f"slip of {metres * 1e3:g} mm, feet roll by {rolling_m} m", TROT,
                   (foot.slip(FOOT, slides, metres), known), events=(slip,))
    slip = Event("slip", slides, 0.06, foot=FOOT, value=(0.05, 1e-3))
    yield Case("slip of 50 mm of a foot that rolls", TROT,
               (foot.rolling(0.03), foot.slip(FOOT, slides, 0.05)), events=(slip,))
    for share in (0.3, 0.5, 0.6):
        at = LEAVES + share * (LANDS - LEAVES)
        trips = Event("stumble", at, foot=FOOT, duration_s=0.05, value=(share, 0.05))
        rows.append((f"stumble at {share:g} of a swing", foot.contact(FOOT, at, at + 0.05), "",
                     steps, (trips,)))
    noisy = pose.pose_noise(0.01), jump
    yield Case("one jump of noisy poses", TROT, noisy, "POSE_JUMP", skip="height",
               events=(replace(jumps, value=(1.25**0.5, 0.05)),))
    for rate_hz in (1.0, 5.0, 10.0, 20.0):
        near = replace(jumps, within_s=1.01 / rate_hz)
        yield Case(f"one jump of the pose at {rate_hz:g} Hz", TROT, (jump, pose.rarely(rate_hz)),
                   "POSE_JUMP", "POSE", events=(near,))
    for name, fault, says, skip, events in rows:
        yield Case(name, TROT, (fault,), says, skip=skip, events=events)
    forward = (3.0, 0.0), (3.5, 0.4), (4.5, 0.4), (5.0, 0.0)
    outside = Event("margin_below_zero", 3.25, 0.25, value=(-0.1, 0.005))
    yield Case("the base leaves its polygon", Scene(scenes.STILL, forward=forward),
               skip="verdict, path, margin", events=(outside,))


def gait_changes() -> Iterator[Case]:
    """Changes of the gait.

    Gaits one after another.
    """
    slow, quick = replace(WALK, seconds=9.0), Walk(seconds=9.0, period_s=0.5)
    for name, walks, codes, skip in (
        ("a stand, then a trot", (scenes.standing(), TROT), ("stand>trot",), "class, strides"),
        ("a trot, then a quicker one", (TROT, quick), ("trot>trot",),
         "stride period, stance, braking, stride length, loading, impact"),
        ("a trot, then a walk, then a trot", (TROT, slow, TROT), ("trot>walk", "walk>trot"),
         "duty factor, peak force, size, margin, stride length"),
    ):
        starts = np.cumsum([each.seconds for each in walks])
        events = tuple(changes(at, code) for at, code in zip(starts, codes, strict=False))
        yield Case(name, OneAfterAnother(walks), skip=skip, events=events)


STANDS: Final = ((0.0, 0.45),)
UPRIGHT: Final = ((0.0, 0.0),)
LOADED: Final = ((0.0, 0.25),)
TOPPLES: Final = ((4.0, 0.0), (4.8, 1.5))
TWICE: Final = ((2.0, 0.0), (2.5, 1.5), (4.0, 1.5), (5.0, 0.0), (7.0, 0.0), (7.5, 1.5))
LIFTED: Final = ((2.0, 0.45), (3.0, 1.2), (5.0, 1.2), (5.4, 0.45))
OFF: Final = ((1.9, 0.25), (2.0, 0.0))
CROUCHES: Final = ((2.0, 0.45), (2.5, 0.22), (4.0, 0.22), (4.5, 0.45))
SWAYS: Final = tuple((each / 2.0, 0.02 * (-1.0) ** each) for each in range(18))
USUAL: Final = ((1.0, 0.0), (1.5, 0.5), (2.0, 0.0), (9.0, 0.0), (10.0, 0.4))


def falls() -> Iterator[Case]:
    """Falls, and what looks like one.

    Height, roll, load of each foot, when the robot falls, and what else happens.
    """
    carried, anew = Event("carried", 2.0, 0.06), Event("pose_jump", 4.0)
    tips, pitches = (Event("tipping", 9.0, 0.3, value=(rad, 1e-6)) for rad in (0.4, -0.4))
    along_y = sensor.user_gives(set={"forward_axis": "+y"})
    special = {"unknown": FORCE, "own axis": along_y, "10 Hz": pose.rarely(10.0)}
    rows: tuple[tuple[str, Knots, Knots, Knots, tuple[float, ...], tuple[Event, ...]], ...] = (
        ("collapses", ((4.0, 0.45), (4.3, 0.1)), UPRIGHT, LOADED, (4.0,), ()),
        ("collapses, poses at 10 Hz", ((4.0, 0.45), (4.3, 0.1)), UPRIGHT, LOADED, (4.0,), ()),
        ("topples over", ((4.0, 0.45), (4.8, 0.15)), TOPPLES, LOADED, (4.0,), ()),
        ("topples over, height unknown", STANDS, TOPPLES, LOADED, (4.0,), ()),
        ("falls twice", STANDS, TWICE, LOADED, (2.0, 7.0), ()),
        ("sits down fast", ((3.0, 0.6), (4.2, 0.18)), UPRIGHT, LOADED, (), ()),
        ("lies, then is turned upright", STANDS, ((3.0, 1.5), (4.0, 0.0)), LOADED, (), ()),
        ("crouches at once", CROUCHES, UPRIGHT, LOADED, (), ()),
        ("is carried on its side", ((2.0, 0.45), (3.0, 1.0)), TOPPLES, OFF, (), (carried,)),
        ("is lifted and put down fast", LIFTED, UPRIGHT, (*OFF, (5.4, 0.0), (5.5, 0.25)), (),
         (carried,)),
        ("is localised anew", ((4.0, 0.45), (4.005, 0.05)), UPRIGHT, LOADED, (), (anew,)),
        ("is carried and localised anew", (*LIFTED[:3], (5.005, 3.2)), UPRIGHT, OFF, (),
         (replace(anew, onset_s=5.0),)),
        ("sits down, no foot loaded", ((3.0, 0.45), (4.2, 0.14)), UPRIGHT,
         ((3.9, 0.25), (4.0, 0.0)), (), ()),
        ("leans by 50 degrees", STANDS, ((3.0, 0.0), (4.0, radians(50.0))), LOADED, (), ()),
        ("climbs down", ((2.0, 1.45), (8.0, 0.45)), UPRIGHT, LOADED, (), ()),
        ("tips as the log ends", STANDS, (*SWAYS, (9.0, 0.02), (10.0, 0.4)), LOADED, (), (tips,)),
        ("tips about its own axis", STANDS, ((9.0, 0.0), (10.0, 0.4)), LOADED, (), (pitches,)),
        ("leans and returns", STANDS, ((8.5, 0.0), (9.0, 0.4), (9.5, 0.0)), LOADED, (), ()),
        ("leans as it did before", STANDS, USUAL, LOADED, (), ()),
        ("leans on a ramp", STANDS, ((8.5, 0.0), (9.3, 0.3)), LOADED, (), ()),
    )
    for name, height, roll, load, falls_s, events in rows:
        truth = replace(scenes.MOVING, falls_s=falls_s)
        scene = Scene(truth, seconds=10.0, height=height, roll=roll, loads=(load,) * 4)
        faults = tuple(fault for word, fault in special.items() if word in name)
        yield Case(f"a robot {name}", scene, faults, cause="FALL|FORWARD|POSE", skip="height",
                   events=events)
# fmt: on

WHEELS = "without steps|wheel"
CARRIED = r"_CARRIED|_LIFTED|\bcarried|\blifted"


def changes(onset_s: float, code: str, within_s: float = 0.8) -> Event:
    """Let the gait change: from one class > to another."""
    return Event("gait_change", onset_s, within_s, code=code)


# fmt: off
def no_steps() -> Iterator[Case]:
    """No steps."""
    yield Case("standing", scenes.standing())
    yield Case("standing, force sensors", scenes.standing(), QUIET)
    yield Case("standing, noisy poses", scenes.standing(), (pose.pose_noise(0.002),), events=())
    yield Case("shifting weight", scenes.shifting_weight())
    yield Case("shifting weight, force sensors", scenes.shifting_weight(), QUIET)
    yield Case("crouching", scenes.crouching())
    yield Case("sitting down", scenes.sitting_down(), skip="verdict")
    yield Case("standing up", scenes.standing_up(), skip="verdict")
    yield Case("falling", scenes.falling(), (), "FALL", "")
    yield Case("tipping", scenes.tipping(), (), r"\btip", "",
               events=(Event("tipping", 7.0, 1.0, code="FALL", value=(0.35, 0.01)),))
    yield Case("rolling on wheels", scenes.rolling(), (),
               r"without steps for 8\.0 s, first at 0\.00 s")
    to_and_fro = (2.0, 0.0), (3.0, 1.0), (5.0, 1.0), (6.0, 0.0)
    yield Case("rolling to and fro on wheels",
               replace(scenes.rolling(), forward=to_and_fro), (), WHEELS, skip="speed, path")
    yield Case("rolling on wheels, force sensors", scenes.rolling(), QUIET, WHEELS)
    for newtons in (-60.0, -20.0, 20.0):
        yield Case(f"rolling on wheels, offset {newtons:+g} N", scenes.rolling(),
                   (*QUIET, sensor.offset(newtons)), WHEELS)


def in_the_air() -> Iterator[Case]:
    """No foot on the ground."""
    lifted = Event("carried", 2.0, 0.06, duration_s=4.0, value=(0.55, 0.05))
    for name, faults, more in (
        ("carried", (), ""),
        ("carried, force sensors", SENSED, "|WITHOUT_STEPS"),
        ("carried while the legs move", (*SENSED, sensor.inertia(6.0)), "|WITHOUT_STEPS"),
        ("carried while the legs move fast", (*SENSED, sensor.inertia(14.0)), "|WITHOUT_STEPS"),
    ):
        yield Case(name, scenes.carried(), faults, CARRIED + more, "",
                   events=None if faults else (lifted,))
    for name, faults in (("bumpers", ()), ("force sensors", SENSED)):
        yield Case(f"sitting, no foot loaded, {name}", scenes.sitting(), faults, skip="verdict")


def sequences() -> Iterator[Case]:
    """A walk, and then."""
    # Where one log ends and the next begins, feet stand elsewhere at once.
    trot, walk = Walk(seconds=12.0), replace(WALK, seconds=9.0)
    stops = changes(12.0, "trot>stand", 0.1)
    lifted = Event("carried", 14.0, 0.06, duration_s=4.0, value=(0.55, 0.05))
    for name, scene, says, skip, also in (
        ("a fall", scenes.falling(), "FALL", "lift-offs", ()),
        ("carried", scenes.carried(), CARRIED, "", (lifted,)),
        ("sitting down", scenes.sitting_down(), "", "", ()),
        ("crouching", scenes.crouching(), "", "", ()),
    ):
        yield Case(f"walk, then {name}", OneAfterAnother((trot, scene)), (), says, "",
                   skip=f"stride length, {skip}", events=(stops, *also))
    for name, first, second, classes, skip, event in (
        ("a trot, then a walk", trot, walk, ("trot", "walk"),
         "duty factor, peak force, size, braking, margin", changes(12.0, "trot>walk")),
        ("a trot, then standing", trot, scenes.standing(), ("trot", "stand"), "", stops),
    ):
        yield Case(name, OneAfterAnother((first, second), classes), skip=f"stride length, {skip}",
                   events=(event,))

# fmt: on
