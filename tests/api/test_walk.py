"""Tables of a walk, against messages decoded one by one, and as other libraries take them."""

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pyarrow as pa
import pytest

import dogbot_logtool as dl
from dogbot_logtool.api.table import Table
from dogbot_logtool.errors import LogtoolError
from tests.measured import walk_of
from tests.oracles.conversion import sample_of
from tests.oracles.recorded import contact_topic, decoded_log
from tests.oracles.small_logs import mixed_contacts, write_bag
from tests.paths import TROUBLED, WALK

FOOT = "front_left"


@pytest.fixture(scope="module")
def walk() -> dl.Walk:
    return walk_of(WALK)


def stamp_s(message: Any, origin: int) -> float:
    stamp = message.header.stamp
    return float((stamp.sec * 1_000_000_000 + stamp.nanosec - origin) / 1e9)


@pytest.mark.parametrize("foot", ["front_left", "front_right"])
def test_samples_are_what_was_recorded(walk: dl.Walk, foot: str) -> None:
    messages = [each.message for each in decoded_log(WALK)[contact_topic(foot)]]
    expected = [sample_of(message, foot) for message in messages]
    samples = walk.samples(foot)

    assert samples["time_s"].tolist() == [stamp_s(each, walk.start_ns) for each in messages]
    assert samples["in_contact"].tolist() == [each.in_contact for each in expected]
    forces = np.array([each.force for each in expected])
    for row, axis in enumerate("xyz"):
        assert samples[f"force_{axis}_n"] == pytest.approx(forces[:, row], rel=1e-6, abs=1e-9)
    assert samples["force_n"] == pytest.approx(np.sqrt((forces**2).sum(axis=1)), rel=1e-6)
    touching = samples["in_contact"]
    places = np.array([each.position for each in expected if each.in_contact])
    assert np.column_stack([samples[f"point_{axis}_m"] for axis in "xyz"])[touching] == (
        pytest.approx(places)
    )
    assert np.isnan(samples["point_x_m"][~touching]).all()


def test_states_of_a_message_are_reduced_as_by_hand(tmp_path: Path) -> None:
    log = write_bag(tmp_path / "log.bag", mixed_contacts())
    found = dl.read(log, robot="dogbot").feet[FOOT]
    nowhere = (math.nan,) * 3
    for row, each in enumerate(decoded_log(log)[contact_topic(FOOT)]):
        expected = sample_of(each.message, FOOT)
        told = found.in_contact[row], found.in_world[row]
        assert told == (expected.in_contact, expected.in_world)
        for name in ("force", "position", "normal"):
            wanted = getattr(expected, name) or nowhere
            assert getattr(found, name)[row] == pytest.approx(wanted, rel=1e-6, nan_ok=True)


def test_states_of_samples_follow_the_stances(walk: dl.Walk) -> None:
    samples, stances = walk.samples("back_left"), walk.stances
    states, time = samples["state"], samples["time_s"]
    rows = stances["foot"] == "back_left"
    for begin, end in zip(stances["touchdown_s"][rows], stances["lift_off_s"][rows], strict=True):
        inside = (time >= begin) & (time < end)
        assert set(states[inside]) == {"stance"}
    assert set(states) == {"stance", "swing"}


def test_a_stance_with_a_gap_is_cut_and_a_dead_foot_is_unknown() -> None:
    troubled = walk_of(TROUBLED)
    time = troubled.samples("front_right")["time_s"]
    gap = int(np.diff(time).argmax())
    stances = troubled.stances
    rows = (stances["touchdown_s"] <= time[gap]) & (stances["lift_off_s"] >= time[gap + 1])
    cut = stances["cut"][rows & (stances["foot"] == "front_right")]
    assert time[gap + 1] - time[gap] > 0.5
    assert cut.tolist() == ["gap"]
    assert set(troubled.samples("back_left")["state"]) == {"unknown"}


def test_a_wrong_foot_lists_those_that_exist(walk: dl.Walk) -> None:
    with pytest.raises(dl.CallError, match="'left' is no foot of this robot; it has front_left"):
        walk.samples("left")
    with pytest.raises(dl.CallError, match="'left' is no foot of this robot"):
        walk.curves("left")


# --- Curves over strides --------------------------------------------------------------------------


def test_curves_pass_through_what_was_recorded(walk: dl.Walk) -> None:
    messages = [each.message for each in decoded_log(WALK)[contact_topic(FOOT)]]
    time = [stamp_s(each, walk.start_ns) for each in messages]
    vertical = [sample_of(each, FOOT).force[2] for each in messages]
    curves = walk.curves(FOOT)
    rows = np.flatnonzero(walk.strides["foot"] == FOOT)
    assert curves["force_z_n"].shape == (len(rows), 101)
    assert (len(curves["start_s"]), len(curves["percent"])) == (len(rows), 101)
    for curve, row in zip(curves["force_z_n"], rows, strict=True):
        start = walk.strides["start_s"][row]
        period = walk.strides["stance_s"][row] + walk.strides["swing_s"][row]
        for percent in (0, 10, 37, 80, 95, 100):
            at = start + period * percent / 100
            assert curve[percent] == pytest.approx(np.interp(at, time, vertical), abs=1e-6)


# --- Tables ---------------------------------------------------------------------------------------


SMALL = Table(
    {
        "foot": np.array(["left", None], np.object_),
        "force_n": np.array([1.5, np.nan]),
        "in_contact": np.array([True, False]),
    }
)


def test_other_libraries_take_a_table_with_null_for_what_is_not_known() -> None:
    frame = SMALL.to_pandas()
    assert frame["in_contact"].tolist() == [True, False]
    frame.loc[0, "force_n"] = 2.0  # a column of its own
    arrow = SMALL.to_arrow()
    assert arrow["force_n"].to_pylist() == [1.5, None]
    assert arrow["foot"].to_pylist() == ["left", None]
    assert pa.table(SMALL) == arrow
    assert pl.DataFrame(SMALL)["force_n"].to_list() == [1.5, None]


def test_a_wrong_column_or_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    assert repr(SMALL) == "<Table of 2 rows: foot, force_n, in_contact>"
    assert len(Table({})) == 0
    with pytest.raises(KeyError, match="the columns are foot, force_n, in_contact"):
        SMALL["forces"]
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(LogtoolError, match="pip install pandas"):
        SMALL.to_pandas()
