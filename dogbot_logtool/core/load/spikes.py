"""Lone spikes of force sensors, told from impacts and kept out of the peaks."""

from dataclasses import replace
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags
from dogbot_logtool.core.contact.stances import Stances

SAME_PHASE: Final = 0.05
"""Share of a stance within which spikes of several stances are at the same phase."""
RECURS: Final = 0.2
"""Share of stances with a spike at the same phase from which it is an impact."""
FEWEST_IMPACTS: Final = 3


def has_lone_spikes(stances: Stances) -> Flags:
    """(n,) tell which stances have spikes that are a fault of the sensor.

    A single sample that stands out of its stance may be real: an impact recurs at the same phase
    of many stances, a fault comes at random.
    """
    phase = stances.figures.spike_phase
    spiked = np.isfinite(phase)
    sorted_phase = np.sort(phase[spiked])
    near = np.searchsorted(sorted_phase, phase + SAME_PHASE, side="right")
    near -= np.searchsorted(sorted_phase, phase - SAME_PHASE, side="left")
    recurring = near >= max(FEWEST_IMPACTS, RECURS * int(stances.whole.sum()))
    lone: Flags = spiked & ~recurring
    return lone


def without_spikes(stances: Stances) -> Stances:
    """Return the stances with the peaks that they have without lone spikes."""
    lone, figures = has_lone_spikes(stances), stances.figures
    peak = np.where(lone, figures.calm_peak_n, figures.peak_n)
    vertical = np.where(lone, figures.calm_peak_vertical_n, figures.peak_vertical_n)
    return replace(stances, figures=figures._replace(peak_n=peak, peak_vertical_n=vertical))
