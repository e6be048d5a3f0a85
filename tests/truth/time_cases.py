"""Logs of clocks and stamps at fault, and of lost messages."""

from collections.abc import Iterator

from tests.truth import gaits
from tests.truth import pose_faults as pose
from tests.truth import time_faults as time
from tests.truth.case import Case
from tests.truth.recording import IN_CONTACT, on
from tests.truth.robots import quadruped
from tests.truth.walking import Walk
from tests.truth.walks import COARSE, SENSED, TROT

CLOCK = r"CLOCK|clocks? of|clocks differ|time are mixed"
LOST = r"lost|GAPS|SILEN"


# fmt: off
def clocks() -> Iterator[Case]:
    """Clocks and stamps."""
    for seconds in (0.1, 0.2, 0.3, -0.2):
        yield Case(f"clock of the feet {seconds:+g} s off", TROT, (time.late_clock(seconds),),
                   CLOCK, known="stride length", shifted=True)
    for late in (0.15, -0.15):
        yield Case(f"clock of the feet {late:+g} s off, jitter 30 ms", TROT,
                   (time.late_clock(late), time.late_delivery(0.02, 0.03)), CLOCK, shifted=True)
        yield Case(f"clock of the feet {late:+g} s off, 3 s", Walk(seconds=3.0),
                   (time.late_clock(late),), CLOCK, shifted=True)
    # Only steps that are not evenly spaced tell a delay from one that is half a stride longer.
    uneven = gaits.Gait("walk", (0.0, 0.5, 0.72, 0.22), 0.75, "lateral")
    walk = Walk(gait=uneven, period_s=1.0, seconds=20.0, shares=(0.29, 0.27, 0.23, 0.21),
                heaves=True)
    for late in (0.0, 0.1, 0.2, 0.3, -0.2):
        yield Case(f"the base heaves, odometry restamped by {late:+g} s", walk,
                   (pose.restamped(late),), CLOCK if late else "",
                   shifted=late < 0.0, known="stride length")
    yield Case("feet on simulation time, odometry on the wall's", TROT,
               (time.late_clock(-1.69e9),), CLOCK, shifted=True)
    yield Case("no stamps at all", TROT, (time.no_stamps(),), "stamp")
    for name, feet in (("feet", True), ("base", False)):
        yield Case(f"no stamps of the {name}", TROT, (time.stamped_in_part(feet=feet),),
                   "LOG_TIME_USED")
    yield Case("simulation at 0.4 of real time", TROT, (time.slow_simulation(2.5),))
    yield Case("messages 50 ms late, 30 ms of jitter", TROT, (time.late_delivery(0.05, 0.03),))
    yield Case("logged in bursts of 0.1 s", TROT, (time.in_bursts(0.1),))
    for message in (0, 500):
        yield Case(f"stamp of message {message} is zero", TROT,
                   (on(time.zero_stamp(message), "front_right"),), "stamp|clock")
    yield Case("two publishers, clocks 5 s apart", TROT, (time.two_publishers(5.0),),
               "stamps .* go backwards")
    yield Case("two messages swapped", TROT, (on(time.swapped_messages(500), "front_right"),),
               "stamp|clock|back")
    yield Case("three messages twice", TROT, (on(time.sent_twice(500, 3), "front_right"),),
               "BAD_STAMPS", "")
    for name, seconds in (("simulation reset", -4.0), ("clock set forward by a year", 3.2e7)):
        yield Case(name, TROT, (time.clock_set(4.0, seconds),), "CLOCK_SET")


def losses() -> Iterator[Case]:
    """Lost messages and silence."""
    swing = IN_CONTACT
    slow = Walk(gait=gaits.symmetrical(0.8, 0.25), period_s=1.0)
    for percent in (2, 5, 10, 15):
        lost = time.lost(percent / 100.0)
        yield Case(f"silent in swing, {percent} % lost", TROT, (swing, lost), cause=LOST)
        for name, walk, faults, rate_hz in (
            ("force sensors, 50 Hz", TROT, (*SENSED, lost), 50.0),
            ("silent in swing, 50 Hz", TROT, (swing, lost), 50.0),
            ("silent in swing, duty 0.8", slow, (swing, lost), 100.0),
        )[: 3 if percent > 2 else 0]:
            yield Case(f"{percent} % lost, {name}", walk, faults, cause=LOST, tolerance=COARSE,
                       rate_hz=rate_hz)
    yield Case("silent in swing", TROT, (swing,))
    yield Case("15 % lost", TROT, (time.lost(0.15),), cause=LOST)
    hung = time.silent_between(3.0, 5.0)
    for name, silent in (
        ("all feet silent for 2 s", (hung,)),
        ("silent in swing, all feet silent for 2 s", (swing, hung)),
        ("one foot silent for 2 s", (on(hung, "back_left"),)),
    ):
        yield Case(name, TROT, silent, r"GAPS|SILEN|drop-?out|all feet", silence_s=(3.0, 5.1))
    walk = Walk(gait=gaits.WALK, robot=quadruped(1.3), period_s=0.79, seconds=6.0, hump=0.0)
    yield Case("logged in bursts of 0.1 s, silent in swing", walk, (swing, time.in_bursts(0.1)))
# fmt: on
