"""Load as the colour of light: the wavelength map of the live script.

The approximation is the widely used piecewise-linear one with intensity falling off towards the
ends of the visible range and a gamma of 0.8. It is exact: equal, as float32, to the plain Python
formulas with the C library's ``pow``.
"""

import math
from typing import Final

import numpy as np

from dogbot_logtool.core.arrays import Flags, Float32s, Floats

SHORTEST_NM: Final = 380.0
LONGEST_NM: Final = 750.0
_GAMMA: Final = 0.8
_POW_ULPS: Final = 8
"""numpy's vectorised pow is within 4 units in the last place of the C library's; twice that."""


def wavelength_to_rgba(wavelength_nm: Floats) -> Float32s:
    """Return the colours of wavelengths of light.

    Args:
        wavelength_nm: (n,). Outside [380, 750], and NaN, is black. A bound between two ranges
            belongs to the lower one.

    Returns:
        (n, 4) red, green, blue in [0, 1] and alpha 1.
    """
    w = wavelength_nm
    rgba = np.zeros((len(w), 4), np.float32)
    rgba[:, 3] = 1.0
    red, green, blue = rgba[:, 0], rgba[:, 1], rgba[:, 2]

    def take(upper_nm: float, lower_nm: float) -> tuple[Flags, Floats]:
        rows = (w > lower_nm) & (w <= upper_nm)
        return rows, w[rows]

    rows = (w >= SHORTEST_NM) & (w <= 440.0)
    v = w[rows]
    attenuation = 0.3 + 0.7 * (v - 380.0) / (440.0 - 380.0)
    red[rows] = _gamma((-(v - 440.0) / (440.0 - 380.0)) * attenuation)
    blue[rows] = _gamma(1.0 * attenuation)

    rows, v = take(490.0, 440.0)
    green[rows] = _gamma((v - 440.0) / (490.0 - 440.0))
    blue[rows] = 1.0

    rows, v = take(510.0, 490.0)
    green[rows] = 1.0
    blue[rows] = _gamma(-(v - 510.0) / (510.0 - 490.0))

    rows, v = take(580.0, 510.0)
    red[rows] = _gamma((v - 510.0) / (580.0 - 510.0))
    green[rows] = 1.0

    rows, v = take(645.0, 580.0)
    red[rows] = 1.0
    green[rows] = _gamma(-(v - 645.0) / (645.0 - 580.0))

    rows, v = take(LONGEST_NM, 645.0)
    attenuation = 0.3 + 0.7 * (750.0 - v) / (750.0 - 645.0)
    red[rows] = _gamma(1.0 * attenuation)
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
