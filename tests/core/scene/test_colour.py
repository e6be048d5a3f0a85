"""The wavelength map, against the plain formulas and what light looks like."""

import math
from typing import Final

import numpy as np
import pytest

from dogbot_logtool.core.scene.colour import LONGEST_NM, SHORTEST_NM, wavelength_to_rgba

PURE: Final = {
    380.0: (0.3**0.8, 0, 0.3**0.8),
    440.0: (0, 0, 1),
    490.0: (0, 1, 1),
    510.0: (0, 1, 0),
    580.0: (1, 1, 0),
    645.0: (1, 0, 0),
    750.0: (0.3**0.8, 0, 0),
}


def rgba(*wavelengths: float) -> list[list[float]]:
    colours: list[list[float]] = wavelength_to_rgba(np.array(wavelengths, np.float64)).tolist()
    return colours


def plain_rgb(w: float) -> tuple[float, float, float]:  # noqa: PLR0911 - a branch a range
    """The formulas as they stand, without a loop or an array."""
    if 380 <= w <= 440:
        a = 0.3 + 0.7 * (w - 380) / (440 - 380)
        return (-(w - 440) / (440 - 380) * a) ** 0.8, 0.0, a**0.8
    if 440 <= w <= 490:
        return 0.0, ((w - 440) / (490 - 440)) ** 0.8, 1.0
    if 490 <= w <= 510:
        return 0.0, 1.0, (-(w - 510) / (510 - 490)) ** 0.8
    if 510 <= w <= 580:
        return ((w - 510) / (580 - 510)) ** 0.8, 1.0, 0.0
    if 580 <= w <= 645:
        return 1.0, (-(w - 645) / (645 - 580)) ** 0.8, 0.0
    if 645 <= w <= 750:
        a = 0.3 + 0.7 * (750 - w) / (750 - 645)
        return a**0.8, 0.0, 0.0
    return 0.0, 0.0, 0.0


@pytest.mark.parametrize("wavelength", PURE)
def test_colours_at_the_bounds(wavelength: float) -> None:
    assert rgba(wavelength) == [pytest.approx([*PURE[wavelength], 1])]


@pytest.mark.parametrize(
    "wavelength",
    [
        math.nextafter(380.0, 0),
        math.nextafter(750.0, 1000),
        0.0,
        -500.0,
        1e300,
        math.inf,
        -math.inf,
        math.nan,
    ],
)
def test_what_is_not_visible_is_opaque_black(wavelength: float) -> None:
    assert rgba(wavelength) == [[0, 0, 0, 1]]


def test_the_ends_of_the_range_are_visible() -> None:
    assert all(sum(colour[:3]) > 0 for colour in rgba(SHORTEST_NM, LONGEST_NM))


def test_a_hundred_thousand_wavelengths_equal_the_plain_formulas_to_the_bit() -> None:
    random = np.random.default_rng(3)
    wavelengths = np.concatenate([random.uniform(370, 760, 100_000), list(PURE)])

    colours = wavelength_to_rgba(wavelengths)

    plain = [(*plain_rgb(wavelength), 1.0) for wavelength in wavelengths.tolist()]
    assert colours.dtype == np.float32
    assert colours.tobytes() == np.array(plain, np.float32).tobytes()


def test_results_beside_a_rounding_boundary_of_float32_are_still_exact() -> None:
    # Wavelengths whose colour lies halfway between two float32 numbers, as near as can be had.
    random = np.random.default_rng(4)
    stored = random.uniform(0.05, 1, 5000).astype(np.float32)
    halfway = (stored.astype(np.float64) + np.nextafter(stored, np.float32(2))) / 2
    wavelengths = 510 + (580 - 510) * halfway**1.25
    around = np.concatenate([wavelengths, np.nextafter(wavelengths, 0)])

    colours = wavelength_to_rgba(around)

    plain = [(*plain_rgb(wavelength), 1.0) for wavelength in around.tolist()]
    assert colours.tobytes() == np.array(plain, np.float32).tobytes()


def test_colours_are_between_zero_and_one() -> None:
    colours = wavelength_to_rgba(np.linspace(300, 800, 20_001))

    assert ((colours >= 0) & (colours <= 1)).all()
    assert (colours[:, 3] == 1).all()


def test_no_wavelengths_give_no_colours() -> None:
    assert wavelength_to_rgba(np.empty(0)).shape == (0, 4)
