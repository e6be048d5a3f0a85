"""Load as the colour of light: the wavelength map of the live script.

The approximation is the widely used piecewise-linear one with intensity falling off towards the
ends of the visible range and a gamma of 0.8. It is exact: equal, as float32, to the plain Python
formulas with the C library's ``pow``.
"""

import math
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Float32s, Floats

EDGES_NM: Final = np.array([380.0, 440.0, 490.0, 510.0, 580.0, 645.0, 750.0])
"""nm, between which colours change evenly; an edge belongs to the range below it."""
SHORTEST_NM: Final = 380.0
LONGEST_NM: Final = 750.0
_GAMMA: Final = 0.8
_POW_ULPS: Final = 8
"""numpy's vectorised pow is within 4 units in the last place of the C library's; twice that."""


def wavelength_to_rgba(wavelength_nm: Floats) -> Float32s:
    """Return the colours of wavelengths of light.

    Args:
        wavelength_nm: (n,). Outside [380, 750], and NaN, is black.

    Returns:
        (n, 4) red, green, blue in [0, 1] and alpha 1.
    """
    part = np.searchsorted(EDGES_NM, wavelength_nm)
    part[wavelength_nm == SHORTEST_NM] = 1
    seen = np.flatnonzero((part > 0) & (part < len(EDGES_NM)))
    v, part = wavelength_nm[seen], part[seen]
    low, high = EDGES_NM[part - 1], EDGES_NM[part]
    rise, fall = (v - low) / (high - low), -(v - high) / (high - low)
    violet = 0.3 + 0.7 * (v - 380.0) / (440.0 - 380.0)
    deep_red = 0.3 + 0.7 * (750.0 - v) / (750.0 - 645.0)
    none, full = np.zeros(len(v)), np.ones(len(v))
    rgba = np.zeros((len(wavelength_nm), 4), np.float32)
    rgba[:, 3] = 1.0
    for channel, ranges in enumerate(
        (
            (fall * violet, none, none, rise, full, deep_red),
            (none, rise, full, full, fall, none),
            (violet, full, fall, none, none, none),
        )
    ):
        rgba[seen, channel] = _gamma(np.choose(part - 1, ranges))
    return rgba


def _gamma(intensity: Floats) -> Float32s:
    """Raise to the power 0.8 and round to float32, exactly as scalar code would.

    numpy may compute pow with a vector instruction set whose last bit differs from the C
    library's. That matters only for results beside a float32 rounding boundary: those few are
    computed one by one.
    """
    power = np.power(intensity, _GAMMA)
    slack = _POW_ULPS * np.spacing(power)
    rounded: Float32s = power.astype(np.float32)
    doubtful = (power - slack).astype(np.float32) != (power + slack).astype(np.float32)
    for row in np.flatnonzero(doubtful):
        rounded[row] = math.pow(intensity[row], _GAMMA)
    return rounded
