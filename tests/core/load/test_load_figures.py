import pytest

from dogbot_logtool.core.load.load_figures import grouped_shares, symmetry_index_percent


def test_equal_sides_have_no_asymmetry() -> None:
    assert symmetry_index_percent(80.0, 80.0) == 0.0


def test_the_index_is_positive_when_the_right_side_has_more() -> None:
    assert symmetry_index_percent(90.0, 110.0) == pytest.approx(20.0)
    assert symmetry_index_percent(110.0, 90.0) == pytest.approx(-20.0)


@pytest.mark.parametrize("sides", [(None, 1.0), (1.0, None), (0.0, 0.0), (-1.0, 1.0)])
def test_the_index_is_unknown_without_sides_or_denominator(
    sides: tuple[float | None, float | None],
) -> None:
    assert symmetry_index_percent(*sides) is None


def test_shares_are_added_up_by_place() -> None:
    places = [("front", "left"), ("front", "right"), ("back", "left"), ("back", "right")]
    shares = grouped_shares([0.2, 0.3, 0.1, 0.4], places)
    assert shares == pytest.approx({"fore": 0.5, "hind": 0.5, "left": 0.3, "right": 0.7})


def test_unknown_places_have_no_shares() -> None:
    assert grouped_shares([0.5, 0.5], [None, ("front", "left")]) == dict.fromkeys(
        ("fore", "hind", "left", "right")
    )
