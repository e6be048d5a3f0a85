"""Sensor offsets taken off contact samples, so that what is drawn is what is measured."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dogbot_logtool.core.contact.contact_rule import FootSensor
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.geometry.arrays import norms


def without_offsets(
    samples: Samples, sensors: Sequence[FootSensor], *, lists_contacts: bool, only_presses: bool
) -> Samples:
    """Return samples less their sensors' offsets; below the off threshold there is no contact.

    Zeros of a sensor that drops out are no measurements, and become NaN.

    Args:
        samples: n samples of any feet.
        sensors: of every foot.
        lists_contacts: whether messages say what touches: then no force ends a contact.
        only_presses: whether the sensors have one axis, along which a foot can only press.
    """
    offset = np.zeros_like(samples.force)
    release = np.zeros(len(samples.foot))
    lost = np.zeros(len(samples.foot), np.bool_)
    for foot, sensor in enumerate(sensors):
        rows = np.flatnonzero(samples.foot == foot)
        level = sensor.level
        if len(rows) and (level.offset.any() or not lists_contacts):
            offset[rows] = level.offset_at(samples.log_time[rows])
            release[rows] = sensor.rule.off_n
        if level.drops_out:
            lost[rows] = (samples.force[rows] == 0.0).all(axis=1)
    if not offset.any() and not release.any() and not lost.any():
        return samples
    force = samples.force - offset
    if only_presses:
        force = np.where(force < 0.0, 0.0, force)
    # A force that is not a number is below no threshold.
    free = norms(force) < release
    force[free] = 0.0
    force[lost] = np.nan
    in_contact = (force != 0.0).any(axis=1)
    if lists_contacts:
        in_contact &= samples.in_contact
    return replace(samples, force=force, in_contact=in_contact)
