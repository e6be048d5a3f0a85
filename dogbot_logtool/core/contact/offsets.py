"""Sensor offsets taken off contact samples, so that what is drawn is what is measured."""

from dataclasses import replace

import numpy as np

from dogbot_logtool.core.arrays import norms
from dogbot_logtool.core.contact.contact_rule import FootSensor
from dogbot_logtool.core.contact.contacts import Samples


def without_offset(
    samples: Samples, sensor: FootSensor, *, lists_contacts: bool, only_presses: bool
) -> Samples:
    """Return samples less their sensor's offset; below the off threshold there is no contact.

    Zeros of a sensor that drops out are no measurements, and become NaN.

    Args:
        samples: n samples of one foot.
        sensor: of that foot.
        lists_contacts: whether messages say what touches: then no force ends a contact.
        only_presses: whether the sensor has one axis, along which a foot can only press.
    """
    level = sensor.level
    reads_offset = bool(level.offset.any()) or not lists_contacts
    if not len(samples.log_time) or not (reads_offset or level.drops_out):
        return samples
    force = samples.force.copy()
    recorded_zero = (force == 0.0).all(axis=1)
    if reads_offset:
        force -= level.offset_at(samples.log_time)
        if only_presses:
            force = np.where(force < 0.0, 0.0, force)
        # A force that is not a number is below no threshold.
        force[norms(force) < sensor.rule.off_n] = 0.0
    if level.drops_out:
        force[recorded_zero] = np.nan
    touches = (force != 0.0).any(axis=1)
    if lists_contacts:
        touches &= samples.in_contact
    return replace(samples, force=force, in_contact=touches)
