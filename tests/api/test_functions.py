"""`import dogbot_logtool`: what it offers, and that it says what the commands say."""

import csv
import doctest
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from mcap.reader import make_reader

import dogbot_logtool as dl
from dogbot_logtool.api import functions
from tests.forked_cli import run
from tests.paths import ROOT, TROT, TROUBLED, WALK


@pytest.fixture(scope="module")
def walk() -> dl.Walk:
    return dl.measure(str(TROT), robot="dogbot")


def test_only_the_public_names_are_listed() -> None:
    assert set(dir(dl)) == {*dl.__all__, "__version__"}
    assert all(getattr(dl, name) is not None for name in dl.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'mesure'"):
        dl.mesure  # type: ignore[attr-defined]  # noqa: B018


def test_the_import_loads_no_library() -> None:
    script = "import sys, dogbot_logtool; sys.exit('numpy' in sys.modules)"
    words = [sys.executable, "-c", script]
    assert subprocess.run(words, check=False, cwd=ROOT).returncode == 0  # noqa: S603


def test_the_examples_in_docstrings_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert doctest.testmod(functions).attempted >= 5
    assert doctest.testmod(functions).failed == 0


def test_figures_are_those_of_stats_json(walk: dl.Walk) -> None:
    printed = json.loads(run("stats", TROT, "--robot", "dogbot", "--json", "-v").stdout)
    assert json.loads(json.dumps(walk.stats)) == printed


def test_strides_are_those_of_csv_and_of_the_dataset_to_the_bit(
    walk: dl.Walk, tmp_path: Path
) -> None:
    run("export", TROT, "--robot", "dogbot", "--dataset", tmp_path / "figures")
    (file,) = (tmp_path / "figures" / "strides").rglob("*.parquet")
    stored = pq.ParquetFile(file).read()
    printed = list(csv.DictReader(run("export", TROT, "--robot", "dogbot").stdout.split("\n")))
    assert len(walk.strides) == len(printed) == stored.num_rows == 24
    assert walk.strides["foot"].tolist() == [row["foot"] for row in printed]
    for name in set(walk.strides) - {"foot"}:
        column = walk.strides[name]
        assert stored[name].to_numpy().tobytes() == column.tobytes()
        numbers = np.array([float(row[name] or "nan") for row in printed])
        assert numbers.tobytes() == column.tobytes()


def test_strides_are_those_of_json_to_the_bit(walk: dl.Walk) -> None:
    """Figures of stances count those that belong to no whole stride, too."""
    equal = set()
    for foot, figures in walk.stats["feet"].items():
        for name in walk.strides:
            column = walk.strides[name][walk.strides["foot"] == foot]
            told = column[~np.isnan(column)] if column.dtype == np.float64 else column
            figure = figures.get(name)
            if isinstance(figure, dict) and figure["n"] == len(told):
                found = [getattr(np, statistic)(told) for statistic in ("min", "median", "max")]
                assert [figure[each] for each in ("min", "median", "max")] == found, name
                equal.add(name)
    assert {"swing_s", "duty_factor", "clearance_m", "step_length_m"} <= equal


def test_options_have_the_names_of_the_command_line() -> None:
    part = dl.measure(
        WALK,
        mass=20.0,
        start=1.0,
        end=6.0,
        contact_on=12.0,
        contact_off=3.0,
        debounce=0.03,
        time_source="log",
        forward_axis="+y",
        wrench_frame="world",
        tare="none",
        foot={"front_left": "/dogbot/front_left_contactsensor_state"},
        odom_topic="/dogbot/odom",
    )
    settings = part.metrics.settings
    assert settings.mass_kg == 20.0
    assert settings.clock == "log"
    assert settings.feet["front_left"].debounce_s == 0.03
    assert part.base["time_s"][-1] <= 5.01


def test_convert_compare_info_and_check(tmp_path: Path) -> None:
    done = dl.convert(WALK, tmp_path / "walk.mcap", style="force", without=["/dogbot/imu"])
    assert not done.damage.losses
    with (tmp_path / "walk.mcap").open("rb") as stream:
        topics = {each.topic for each in make_reader(stream).get_summary().channels.values()}  # type: ignore[union-attr]
    assert "/load/front_left" in topics
    assert "/dogbot/imu" not in topics
    assert dl.compare(WALK, str(WALK)).exit_code == 0
    assert dl.info(tmp_path / "walk.mcap").robot == "dogbot"
    limits = tmp_path / "limits.toml"
    limits.write_text('[[rule]]\nfigure = "gait.name"\nequals = "trot"\n')
    (judgement,) = dl.check(WALK, limits)
    assert (judgement.status, judgement.value) == ("FAIL", "walk")


def test_errors_are_exceptions_with_sentences(tmp_path: Path) -> None:
    with pytest.raises(dl.CallError, match="no such file"):
        dl.measure(tmp_path / "nothing.bag")
    (tmp_path / "text.bag").write_text("no log")
    with pytest.raises(dl.LogError):
        dl.measure(tmp_path / "text.bag")
    with pytest.raises(dl.CallError, match="exists"):
        dl.convert(TROT, TROUBLED)
    assert issubclass(dl.CallError, dl.LogtoolError)
    assert issubclass(dl.LogError, dl.LogtoolError)


def test_damage_is_told(tmp_path: Path) -> None:
    data = TROT.read_bytes()
    (tmp_path / "cut.bag").write_bytes(data[: len(data) // 2])
    cut = dl.measure(tmp_path / "cut.bag")
    assert cut.damaged
    assert "W_LOST" in {each["code"] for each in cut.stats["findings"]}
    assert not np.isnan(cut.strides["duty_factor"]).any()
