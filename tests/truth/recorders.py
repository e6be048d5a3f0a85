"""What records a walk for a case."""

from collections.abc import Callable
from typing import Final

from tests.truth import sensor_faults as sensor
from tests.truth.recording import Disturbance, Recording, disturbed
from tests.truth.walking import Walk

RATE_HZ: Final = 200.0
FORCE: Final = sensor.as_force_sensors


def recorder(
    walk: Walk, *disturbances: Disturbance, rate_hz: float = RATE_HZ
) -> Callable[[], Recording]:
    """Return what records a walk, disturbed."""
    odometry_hz = min(rate_hz, 100.0)
    return lambda: disturbed(walk.recorded(rate_hz, odometry_hz), *disturbances)
