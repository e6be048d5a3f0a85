"""A robot that stands, and lifts a foot for a while; its log has no transforms of the legs."""

from pathlib import Path
from typing import Final

from tests.oracles.recorded import CONTACTS_TYPE, ODOMETRY, ODOMETRY_TYPE, contact_topic
from tests.oracles.ros1_logs import Entry, contact, contacts, odometry, write_ros1_mcap

S: Final = 1_000_000_000
START: Final = 10 * S
BASE: Final = (1.0, 2.0, 0.5)
"""m, its place in the world; it is not turned."""
FEET: Final = {
    "front_left": (0.3, 0.2, -0.5),
    "front_right": (0.3, -0.2, -0.5),
    "back_left": (-0.3, 0.2, -0.5),
    "back_right": (-0.3, -0.2, -0.5),
}
"""m, from the base: +x is forward."""
LIFTED: Final = "back_right"
LIFTED_S: Final = (0.4, 0.8)
"""s after the start."""


def write_standing_log(path: Path) -> Path:
    """Write one second of it, at 100 Hz."""
    entries = []
    for index in range(100):
        time = START + index * S // 100
        entries.append(Entry(ODOMETRY, ODOMETRY_TYPE, time, odometry(time, BASE)))
        for foot, offset in FEET.items():
            x, y, z = (a + b for a, b in zip(BASE, offset, strict=True))
            lifted = foot == LIFTED and LIFTED_S[0] <= index / 100 < LIFTED_S[1]
            states = [] if lifted else [contact((0.0, 0.0, 50.0), foot, ((x, y, z),))]
            entries.append(Entry(contact_topic(foot), CONTACTS_TYPE, time, contacts(time, *states)))
    return write_ros1_mcap(path, entries)
