"""Results in order, errors from where they arise, no more work in flight than is wanted."""

import threading
from collections.abc import Iterator

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dogbot_logtool.parallel import in_order


@settings(max_examples=30)
@given(st.lists(st.integers()), st.integers(1, 5))
def test_results_come_in_the_order_of_the_items(items: list[int], jobs: int) -> None:
    assert list(in_order(lambda item: (item, str(item)), items, jobs)) == [
        (item, str(item)) for item in items
    ]


@pytest.mark.parametrize("jobs", [2, 3, 4])
def test_an_early_item_that_takes_long_still_comes_first(jobs: int) -> None:
    second_is_done = threading.Event()

    def work(item: int) -> int:
        if item == 0:
            assert second_is_done.wait(30)
        if item == 1:
            second_is_done.set()
        return item

    assert list(in_order(work, range(20), jobs)) == list(range(20))


@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_items_are_taken_only_as_threads_become_free(jobs: int) -> None:
    taken = 0

    def items() -> Iterator[int]:
        nonlocal taken
        for number in range(100):
            taken += 1
            yield number

    for got, result in enumerate(in_order(lambda item: item, items(), jobs), start=1):
        assert result == got - 1
        assert taken <= got + jobs
    assert taken == 100


@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_an_error_comes_at_its_place(jobs: int) -> None:
    def work(item: int) -> int:
        if item == 5:
            raise ValueError("five")
        return item

    results = in_order(work, range(100), jobs)
    assert [next(results) for _ in range(5)] == [0, 1, 2, 3, 4]
    with pytest.raises(ValueError, match="five"):
        next(results)


@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_an_error_of_the_items_is_raised(jobs: int) -> None:
    def items() -> Iterator[int]:
        yield 1
        raise OSError("no more")

    results = in_order(lambda item: item, items(), jobs)
    with pytest.raises(OSError, match="no more"):
        list(results)


@pytest.mark.parametrize("jobs", [2, 4])
def test_work_stops_when_no_one_takes_results(jobs: int) -> None:
    begun: list[int] = []

    def work(item: int) -> int:
        begun.append(item)
        return item

    results = in_order(work, range(1000), jobs)
    assert next(results) == 0
    results.close()  # type: ignore[attr-defined]
    assert len(begun) <= jobs + 2
    assert not [t for t in threading.enumerate() if t.name.startswith("batch")]


def test_one_job_works_in_this_thread() -> None:
    here = threading.current_thread()
    assert set(in_order(lambda _: threading.current_thread(), range(5), 1)) == {here}


def test_nothing_to_do() -> None:
    assert list(in_order(str, [], 1)) == []
    assert list(in_order(str, [], 3)) == []
