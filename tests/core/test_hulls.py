import numpy as np
import pytest

from dogbot_logtool.core.hulls import centre_of_pressure, hulls, margin_in

SQUARE = np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]])
NOWHERE = (np.nan, np.nan)


@pytest.mark.parametrize(
    ("body", "margin"),
    [
        ((0.0, 0.0), 1.0),
        ((0.75, 0.0), 0.25),
        ((1.0, 0.0), 0.0),
        ((1.5, 0.0), -0.5),
        ((2.0, 2.0), -np.sqrt(2.0)),
    ],
)
def test_margin_in_a_square(body: tuple[float, float], margin: float) -> None:
    assert margin_in(hulls(SQUARE[None]), np.array([body]))[0] == pytest.approx(margin)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 1, 0, 2), (2, 0, 3, 1)])
def test_the_order_of_the_feet_does_not_matter(order: tuple[int, ...]) -> None:
    assert margin_in(hulls(SQUARE[list(order)][None]), np.array([[0.5, 0.2]]))[0] == 0.5


def test_three_feet_make_a_triangle() -> None:
    three = SQUARE.copy()
    three[3] = NOWHERE
    # The diagonal from (1, -1) to (-1, 1) passes the origin.
    margins = margin_in(hulls(np.stack([three, three])), np.array([[0.0, 0.0], [0.3, 0.3]]))
    assert margins == pytest.approx([0.0, 0.3 * np.sqrt(2.0)])


def test_a_foot_inside_the_others_does_not_matter() -> None:
    inner = np.concatenate([SQUARE[:3], [[0.5, 0.5]]])
    outer = np.concatenate([SQUARE[:3], [NOWHERE]])
    body = np.array([[0.6, 0.2]])
    assert margin_in(hulls(inner[None]), body) == pytest.approx(margin_in(hulls(outer[None]), body))


def test_feet_in_a_row_span_nothing() -> None:
    row = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], NOWHERE])
    assert np.isnan(margin_in(hulls(row[None]), np.array([[0.5, 0.0]]))[0])


def test_the_centre_of_pressure_is_the_loads_mean_place() -> None:
    load = np.array([[30.0, 10.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
    centre = centre_of_pressure(np.stack([SQUARE, SQUARE]), load)
    assert centre[0].tolist() == [1.0, 0.5]
    assert np.isnan(centre[1]).all()
