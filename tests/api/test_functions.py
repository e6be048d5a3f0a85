"""`import dogbot_logtool`: what it offers, and that it says what the commands say."""

import csv
import doctest
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

import dogbot_logtool as dl
from dogbot_logtool.api import functions
from tests.forked_cli import run
from tests.measured import walk_of
from tests.paths import ROOT, TROT, TROUBLED, WALK

FOOT = "/dogbot/front_left_contactsensor_state"


def plain(stats: Any) -> Any:
    return json.loads(json.dumps(stats))


def test_only_the_public_names_are_listed() -> None:
    assert set(dir(dl)) == {*dl.__all__, "__version__"}
    assert len(dl.__all__) <= 14
    assert all(getattr(dl, name) is not None for name in dl.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'mesure'"):
        dl.mesure  # type: ignore[attr-defined]  # noqa: B018


def test_the_examples_in_docstrings_hold(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert doctest.testmod(functions).attempted >= 5
    assert doctest.testmod(functions).failed == 0


def test_strides_are_those_of_csv_and_of_the_dataset_to_the_bit(tmp_path: Path) -> None:
    walk = dl.measure(str(TROT), robot="dogbot")
    run("export", TROT, "--robot", "dogbot", "--dataset", tmp_path / "figures")
    (file,) = (tmp_path / "figures" / "strides").rglob("*.parquet")
    stored = pq.ParquetFile(file).read()
    printed = list(csv.DictReader(run("export", TROT, "--robot", "dogbot").stdout.split("\n")))
    assert len(walk.strides) == len(printed) == stored.num_rows == 24
    stance_s = walk.feet["front_left"].stance_s
    assert stance_s is not None
    assert stance_s.median == walk.stats["feet"]["front_left"]["stance_s"]["median"]
    assert walk.strides["foot"].tolist() == [row["foot"] for row in printed]
    for name in set(walk.strides) - {"foot"}:
        column = walk.strides[name]
        assert stored[name].to_numpy().tobytes() == column.tobytes()
        numbers = np.array([float(row[name] or "nan") for row in printed])
        assert numbers.tobytes() == column.tobytes()


def test_the_same_options_measure_the_same() -> None:
    settings = {
        "contact_on_n": 12,
        "contact_off_n": 3,
        "debounce_s": 0.03,
        "clock": "log",
        "forward_axis": "+y",
        "wrench_frame": "world",
        "tare.front_left": (1, 2, 3),
        "imu_topic": "/dogbot/imu",
    }
    words = [
        *("--start", 1, "--end", 6, "--mass", 20, "--odom-topic", "/dogbot/odom"),
        *("--robot", "dogbot", "--foot", f"front_left={FOOT}"),
    ]
    for name, value in settings.items():
        text = "1,2,3" if isinstance(value, tuple) else value
        words += ["--set", f"{name}={text}"]
    printed = json.loads(run("stats", WALK, *words, "--json", "-v").stdout)
    walk = dl.measure(
        WALK,
        start=1,
        end=6,
        mass=20,
        odom_topic="/dogbot/odom",
        robot="dogbot",
        foot={"front_left": FOOT},
        set=settings,
    )
    assert plain(walk.stats) == printed
    told = walk.metrics.settings
    assert (told.clock, told.mass_kg, told.feet["front_left"].debounce_s) == ("log", 20.0, 0.03)


def test_frames_gaits_pages_and_figures(tmp_path: Path) -> None:
    assert dl.info(TROT, frames=True, jobs=2).frames is not None
    printed = json.loads(run("compare", TROT, WALK, "--gait", "--json").stdout)
    compared = dl.compare_gait(TROT, [WALK])
    assert [each.metric for each in compared.differences] == [
        each["metric"] for each in printed["differences"]
    ]
    words = run("report", TROT, "--no-replay", "-o", tmp_path / "words.html", "--jobs", 3, "--json")
    assert json.loads(words.stdout)["bytes"] == (tmp_path / "words.html").stat().st_size
    figure = run("stats", TROT, "--figure", tmp_path / "words.svg", "--jobs", 3, "--json")
    assert json.loads(figure.stdout)["gait"]["name"] == "trot"
    assert re.search(r"words.svg: \d\.\d\d to \d\.\d\d s", figure.stderr)
    walk = walk_of(TROT)
    walk.report(tmp_path / "keywords.html", replay=False)
    start, end = walk.plot(tmp_path / "keywords.svg")
    assert 0.0 < start < end < 8.0
    for suffix in ("html", "svg"):
        files = (tmp_path / f"{name}.{suffix}" for name in ("words", "keywords"))
        assert len({file.read_bytes() for file in files}) == 1
    with pytest.raises(dl.CallError, match="exists already"):
        walk.plot(tmp_path / "keywords.svg")


def test_a_log_is_read_as_columns() -> None:
    recording = dl.read(WALK)
    samples = recording.feet["front_left"]
    assert samples.force.shape == (len(samples.log_time), 3)
    walk = walk_of(WALK)
    recorded = (samples.stamp - walk.start_ns) / 1e9
    assert recorded.tolist() == walk.samples("front_left")["time_s"].tolist()
    assert repr(recording).endswith("2,251 poses>")


def test_convert_compare_info_and_check(tmp_path: Path) -> None:
    words = ("--style", "force", "--topics", "/dogbot/*", "--topics", "!*imu", "--tf-rate", 0)
    assert run("convert", WALK, *words, "-o", tmp_path / "words.mcap").returncode == 0
    topics = ["/dogbot/*", "!*imu"]
    done = dl.convert(WALK, tmp_path / "walk.mcap", style="force", topics=topics, tf_rate=0)
    assert not done.damage.losses
    assert (tmp_path / "words.mcap").read_bytes() == (tmp_path / "walk.mcap").read_bytes()
    with pytest.raises(dl.CallError, match="style='loud': must be one of pressure, force, classic"):
        dl.convert(WALK, tmp_path / "loud.mcap", style="loud")
    assert dl.compare(WALK, str(WALK)).exit_code == 0
    assert dl.info(tmp_path / "walk.mcap").robot == "dogbot"
    limits = tmp_path / "limits.toml"
    limits.write_text('[[rule]]\nfigure = "gait.name"\nequals = "trot"\n')
    (judgement,) = dl.check(WALK, limits)
    assert (judgement.status, judgement.value) == ("FAIL", "walk")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"mass": -1.0}, "mass=-1.0: must be a number from 0.001 to 1e+06"),
        ({"start": 1e10}, "must be a number of seconds"),
        ({"jobs": 1.5}, "jobs=1.5: must be a whole number"),
        ({"join": "b.bag"}, "join='b.bag': must be True or False"),
        ({"set": {"contact_on_n": "much"}}, "must be a number above 0"),
        ({"set": {"wrench_frame": "earth"}}, "must be one of auto, world, link"),
        ({"set": {"tare.front_left": (0.0, 1.0)}}, "must be three numbers"),
        ({"set": {"tare.nose": (0.0, 1.0, 2.0)}}, "the log has no such foot"),
    ],
)
def test_bad_values_are_refused(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(dl.CallError, match=re.escape(sentence)):
        dl.measure(TROT, **options)


def test_an_option_that_does_not_exist_is_refused() -> None:
    with pytest.raises(TypeError, match="no option 'contact'; there are end, foot, jobs"):
        dl.measure(TROT, contact=3.0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="no option 'mas'"):
        dl.info(TROT, mas=3.0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="'tare' is gone: use --set tare"):
        dl.measure(TROT, tare="none")  # type: ignore[call-arg]


def test_errors_are_exceptions_with_sentences(tmp_path: Path) -> None:
    with pytest.raises(dl.CallError, match="join=True"):
        dl.measure([TROT, WALK])
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
    assert "LOST" in {each["code"] for each in cut.stats["findings"]}
