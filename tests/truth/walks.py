"""Walks and robots that the tables of cases share, and how coarse a log may be."""

from typing import Final

from tests.truth import gaits
from tests.truth.case import Tolerance
from tests.truth.recording import FORCE
from tests.truth.robots import biped, hexapod, quadruped
from tests.truth.sensor_faults import noise, user_gives
from tests.truth.walking import Walk

NO_MASS: Final = user_gives(mass=None)
"""The user gives no mass."""
SENSED: Final = FORCE, noise(1.0)
QUIET: Final = FORCE, noise(0.5)

TROT: Final = Walk()
LONG: Final = Walk(seconds=16.0)
WALK: Final = Walk(gait=gaits.WALK, period_s=1.0)
SLOW: Final = Walk(gait=gaits.WALK, period_s=1.2, speed_mps=0.3, seconds=12.0)
TALL: Final = Walk(gait=gaits.BIPED_WALK, robot=biped(80.0), period_s=1.2, seconds=40.0)
BIPED: Final = Walk(gait=gaits.BIPED_WALK, robot=biped(), period_s=1.1, speed_mps=0.8)
WAVE: Final = Walk(gait=gaits.WAVE, robot=hexapod(), period_s=2.0, speed_mps=0.05, seconds=24.0)
LIGHT: Final = Walk(robot=quadruped(0.5))

COARSE: Final = Tolerance(event_s=0.08, duty=0.08, contact=0.06, force=0.15, margin=0.035)
"""Of robots with several faults at once, or hardly any samples."""
ROUGH: Final = Tolerance(event_s=0.04, duty=0.05, contact=0.05)
