"""Findings about what unloaded sensors read, and whether contact can be told from it."""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from dogbot_logtool.core.contact.contact_rule import FootSensor
from dogbot_logtool.finding import Finding

PLAIN: Final = 0.02
"""Share of the weight from which an offset is worth a finding."""


def sensor_findings(
    names: Sequence[str], sensors: Sequence[FootSensor], weight_n: float | None
) -> Iterator[Finding]:
    """Yield what a user should know of the feet's sensors.

    Args:
        names: of the feet.
        sensors: of the feet.
        weight_n: N, given or estimated; None: not known.
    """
    for name, sensor in zip(names, sensors, strict=True):
        yield from _of_foot(name, sensor, weight_n, f"feet.{name}.force_offset_n")


def _of_foot(
    name: str, sensor: FootSensor, weight_n: float | None, where: str
) -> Iterator[Finding]:
    level = sensor.level
    if sensor.rule.unusable:
        text = f"contact of {name} is not known: {sensor.rule.unusable}"
        yield Finding("W_CONTACT_UNKNOWN", text, f"feet.{name}.contact_fraction")
    if level.reason:
        text = f"what the sensor of {name} reads without load is not known, zero is assumed: "
        yield Finding("N_OFFSET_UNKNOWN", text + level.reason, where)
        return
    offset = float(np.linalg.norm(level.offset_n))
    scale = weight_n or level.loaded_n
    if level.moved_n:
        text = (
            f"what the sensor of {name} reads without load moves by {level.moved_n:.3g} N in the "
            "log: it was re-zeroed, or it drifts; that is taken off swing by swing"
        )
        yield Finding("N_SENSOR_MOVES", text, where)
    if scale and offset > PLAIN * scale:
        of_what = "weight" if weight_n else "usual load"
        text = (
            f"the sensor of {name} reads {offset:.3g} N without load, {offset / scale:.0%} of the "
            f"{of_what} ({level.origin}); it is taken off all forces (--tare changes that)"
        )
        yield Finding("N_SENSOR_OFFSET", text, where)
