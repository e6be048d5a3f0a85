"""The page as bytes: what it holds, and that nothing of a log gets out of its place."""

import base64
import json
import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest

from dogbot_logtool.commands.report import replay_of
from dogbot_logtool.commands.stats import measure, measure_log
from dogbot_logtool.core.walk import Walk as MeasuredWalk
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.loss import Damage, Loss
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.report.page.render import Beside, page
from dogbot_logtool.report.page.replay import MOST_FRAMES, frame_times, replay
from dogbot_logtool.report.page.tables import outliers
from dogbot_logtool.report.text.gait_diagram import default_window
from dogbot_logtool.robot.recorded import open_recorded
from tests.measured import measured, measurement_of
from tests.oracles import walks
from tests.oracles.small_logs import odometry_log
from tests.paths import TROT, TROUBLED
from tests.truth import gaits, physics
from tests.truth.free_walker import trot
from tests.truth.log_file import write_log
from tests.truth.physics import KEPT_S
from tests.truth.recording import FLAGS, FootRecording, Recording
from tests.truth.robots import biped
from tests.truth.walking import Walk

MB: Final = 1_000_000
HOSTILE: Final = "</script><img src=x onerror=alert(1)>%{x}<b>{{7*7}}\u2028\u202e\x1b[31m"


@cache
def trot_page() -> bytes:
    return page(measured(TROT), 0)


def page_of(walk: MeasuredWalk, size: int = 0, **facts: Any) -> str:
    """The page of a walk that a test made up or changed."""
    return page(measurement_of(walk, **facts), size).decode()


def drawings(html: bytes) -> dict[str, Any]:
    """Return the figures by name."""
    (text,) = re.findall(
        r'<script type="application/json" id="drawings">(.*?)</script>', html.decode(), re.DOTALL
    )
    return {each["name"]: each for each in json.loads(text)}


def numbers(column: Any) -> Any:
    """Return a column as an array: Plotly packs arrays in base64."""
    if isinstance(column, dict):
        packed = np.frombuffer(base64.b64decode(column["bdata"]), np.dtype(column["dtype"]))
        if "step" not in column:
            return packed
        known = np.where(packed == -32768, np.nan, packed)
        return (known + 32767.0) * column["step"] + column["lowest"]
    return np.array(column, np.float64)


def trace(drawing: Any, name: str) -> Any:
    """Return the one trace of a figure with a name."""
    (found,) = [each for each in drawing["data"] if each.get("name") == name]
    return found


class Tags(HTMLParser):
    """Counts the elements of a page, and what they would load."""

    def __init__(self, html: bytes) -> None:
        super().__init__()
        self.seen: list[str] = []
        self.loads: list[str] = []
        self.ids: list[str] = []
        self.feed(html.decode())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append(tag)
        for name, value in attrs:
            if name in {"src", "href", "srcset", "data"} or name.startswith("on"):
                self.loads.append(f"{name}={value}")
            if name == "id":
                self.ids.append(value or "")


def test_the_page_loads_nothing_and_has_each_id_once() -> None:
    tags = Tags(trot_page())
    assert set(tags.loads) == {"href=#findings", "href=#events"}
    assert len(tags.ids) == len(set(tags.ids))
    counts = {tag: tags.seen.count(tag) for tag in ("script", "figure", "h1")}
    assert counts == {"script": 3, "figure": 7, "h1": 1}
    assert len(trot_page()) < 1.5 * MB


def test_texts_of_a_log_stay_texts() -> None:
    walk = measured(TROT).walk
    names = {foot.name: f"{HOSTILE}{row}" for row, foot in enumerate(walk.feet)}
    feet = tuple(foot._replace(name=names[foot.name], topic=HOSTILE) for foot in walk.feet)
    assert walk.main is not None
    gait = walk.main.gait
    phase = {names[name]: each for name, each in gait.phase.items()}
    main = walk.main._replace(gait=replace(gait, phase=phase))
    topics = tuple(topic._replace(topic=HOSTILE) for topic in walk.corrected.topics)
    html = page_of(
        replace(walk, feet=feet, corrected=walk.corrected._replace(topics=topics), main=main),
        100,
        path=f"a/{HOSTILE.replace('/', '')}",
        damage=Damage(HOSTILE, (Loss(1, HOSTILE, 2),)),
        findings=[Finding("FEET_UNSURE", HOSTILE)],
    )
    tags = Tags(html.encode())
    assert "img" not in tags.seen
    assert tags.seen.count("script") == Tags(trot_page()).seen.count("script")
    assert "<img" not in html.replace('"<img', "")  # Plotly's script names the tag
    assert "\x1b" not in html
    assert "\u202e" not in html
    assert "{{7*7}}" in html
    shown = drawings(html.encode())["gait"]["layout"]["yaxis"]["ticktext"]
    assert not [label for label in shown if "<" in label or "%{" in label]


def test_the_policy_names_the_scripts_that_run() -> None:
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', trot_page().decode())
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe-inline'; img-src" in policy
    assert "unsafe-inline" not in policy.split(";")[1]
    beside = page(measured(TROT), 0, beside=Beside("shared.js", "index.html")).decode()
    assert "script-src 'self' file:; style-src" in beside
    assert len(beside) < MB


def test_figures_agree_with_the_stats() -> None:
    walk, document = measured(TROT).walk, stats_json(measured(TROT))
    shown = drawings(trot_page())
    for foot in walk.feet:
        told = document["feet"][foot.name]
        force = numbers(trace(shown["loads"], f"{foot.name} |F|")["y"])
        assert np.nanmax(force) == pytest.approx(told["peak_force_n"]["max"], abs=2e-3)
        touchdown = walk.seconds(foot.record.stances.touchdown)
        assert len(numbers(trace(shown["ground"], foot.name)["x"])) == len(touchdown)
        _, down = (each for each in shown["gait"]["data"] if each["name"] == foot.name)
        assert numbers(down["base"]) == pytest.approx(np.array(touchdown), abs=1e-9)
        cycles = [each for each in shown["cycle"]["data"] if each["name"] == foot.name]
        keys = ("vertical_over_stride_n", "forward_over_stride_n")
        for found, wanted in zip(cycles, (told[key] for key in keys), strict=True):
            assert numbers(found["y"]) == pytest.approx(np.array(wanted["median"]), abs=2e-3)
            bounds = numbers(found["customdata"]).reshape(-1, 2)
            assert bounds[:, 0] == pytest.approx(np.array(wanted["lower"]), abs=2e-3)
    known = {each["name"]: numbers(each["y"]) for each in shown["motion"]["data"]}
    base = document["base"]
    for name, wanted, scale in (
        ("static margin", document["stability"]["static_margin_m"], 1e3),
        ("height over the feet", base["height_m"], 1.0),
        ("roll", base["roll_rad"], 180.0 / np.pi),
        ("pitch", base["pitch_rad"], 180.0 / np.pi),
    ):
        extremes = np.nanmin(known[name]), np.nanmax(known[name])
        truth = wanted["min"] * scale, wanted["max"] * scale
        assert extremes == pytest.approx(truth, rel=1e-3, abs=1e-3)
    speed = np.nanmedian(known["speed forward"])
    assert speed == pytest.approx(base["forward_speed_mps"], rel=0.02)


def test_a_fall_or_a_doubt_is_the_headline() -> None:
    walk = measured(TROT).walk
    start = walk.origin + 2_000_000_000
    html = page_of(replace(walk, fallen=np.array([[start, walk.end]], np.int64)))
    assert re.search(r'class="verdict unknown">Fall at 2\.0 s<', html)
    assert '<p class="gait">Gait: trot (high confidence' in html
    bands = [
        each["layout"]["shapes"] for each in drawings(html.encode()).values() if each["over_time"]
    ]
    assert all((band[0]["x0"], band[0]["y0"], band[0]["y1"]) == (2.0, 0.0, 1.0) for band in bands)


def test_damage_is_marked_where_it_is_in_the_file() -> None:
    html = page_of(measured(TROT).walk, 1000, damage=Damage("x", (Loss(250, "gone", 100),)))
    assert "left:25.000%;width:10.000%" in html
    assert "Data quality: DAMAGED" in html


def test_events_are_listed_and_marked_in_every_figure_over_time() -> None:
    """Of four feet the third is dead and the second silent: their events stand in their rows."""
    html = page(measured(TROUBLED), 0)
    onsets = [float(each) for each in re.findall(rb'"row"><button[^>]* data-from="(.*?)"', html)]
    assert len(onsets) == 2
    assert html.index(b"sensor fault</td>") < html.index(b"gap</td>")
    over_time = {name: each for name, each in drawings(html).items() if each["over_time"]}
    assert set(over_time) == {"gait", "loads", "motion", "commands"}
    in_rows = {"gait": [("y", 2.0), ("y", 1.0)], "loads": [("y3 domain", 0.5), ("y2 domain", 0.5)]}
    for name, each in over_time.items():
        shapes = each["layout"]["shapes"]
        assert [shape["x0"] for shape in shapes] == onsets
        rows = [(shape["yref"], (shape["y0"] + shape["y1"]) / 2.0) for shape in shapes]
        assert rows == in_rows.get(name, [("paper", 0.5)] * 2)
    (label,) = over_time["gait"]["layout"]["annotations"]
    assert label["text"] == "sensor fault"


STEPS = Walk(gaits.BIPED_WALK, biped(20.0), period_s=1.0, seconds=1500.0)


def spiked(recording: Recording) -> Recording:
    """Peaks of their own, each higher than the one before."""

    def change(_: int, foot: FootRecording) -> FootRecording:
        force, rows = foot.force.copy(), np.searchsorted(foot.time, SPIKES)
        force[rows] = np.outer(500.0 + np.arange(len(SPIKES)), (0.0, 0.0, 1.0))
        touching = foot.touching | (force[:, 2] > 0.0)
        return replace(foot, force=force, touching=touching)

    return recording.each_foot(change)


SPIKES = np.arange(30.0, 1490.0, 61.7)


def test_a_page_of_a_long_log_is_small_and_has_every_peak(tmp_path: Path) -> None:
    log = write_log(spiked(STEPS.recorded(25.0, 5.0)), tmp_path / "log.mcap")
    done = measure(log, MeasureOptions())
    html = page(done, 0)
    assert len(html) < 2.5 * MB
    shown = drawings(html)
    start_s, end_s = default_window(done.walk)
    frames = (frame_times(done.walk, ()) - done.walk.origin) / 1e9
    assert len(frames) <= MOST_FRAMES
    assert np.diff(frames).max() > 0.1
    assert frames[-1] > 1490.0
    typical = frames[(frames > start_s) & (frames < end_s)]
    assert np.diff(typical).max() == pytest.approx(0.04)
    time = numbers(trace(shown["loads"], "left |F|")["x"])
    near = time[(time > start_s) & (time < end_s)]
    assert np.diff(near).max() == pytest.approx(0.04, abs=1e-3)
    for side in ("left", "right"):
        force = numbers(trace(shown["loads"], f"{side} |F|")["y"])
        peaks = np.sort(force[force > 499.5])
        assert peaks == pytest.approx(500.0 + np.arange(len(SPIKES)), abs=0.01)
        assert len(force) <= 2 * 8192
    assert b"export has them all" in html


def test_a_page_says_what_its_log_lacks(tmp_path: Path) -> None:
    flags = FLAGS(Walk(gaits.WALK, period_s=1.0).recorded(100.0))
    html = page(measure(write_log(flags, tmp_path / "log.mcap"), MeasureOptions()), 0)
    assert b"tell contact, not force" in html
    assert b"walk (high confidence" in html
    bare = replace(flags, base=flags.base.pick(np.arange(0)))
    html = page(measure(write_log(bare, tmp_path / "log.mcap"), MeasureOptions()), 0)
    assert not drawings(html).keys() & {"ground", "motion"}
    log = odometry_log(tmp_path / "log.mcap", "/odom")
    html = page(measure(log, MeasureOptions()), 0)
    assert not drawings(html).keys() & {"gait", "loads"}
    assert b"no contacts that could be used" in html


@pytest.mark.parametrize(
    ("values", "marks"),
    [
        ([0.50, 0.51, 0.49, 0.50, 0.52, 0.48, 0.51, 0.49, 0.8, 0.2], {8: 1, 9: -1}),
        # One sample more is no event in an even walk, whose durations have no spread.
        ([0.300] * 20 + [0.304], {}),
        ([0.0] * 20 + [0.03], {20: 1}),
        ([1.0] * 11 + [1.2] * 8, {}),
        ([1.0, 1.0, 1.0, 50.0], {}),
    ],
)
def test_strides_far_from_the_others_are_marked(values: list[float], marks: dict[int, int]) -> None:
    found, _ = outliers(np.array(values))
    assert {row: mark for row, mark in enumerate(found.tolist()) if mark} == marks


# --- The replay -----------------------------------------------------------------------------------


@cache
def replayed(path: Path) -> dict[str, Any]:
    log = open_recorded(path)
    try:
        drawn = replay_of(measure_log(log, MeasureOptions()))
    finally:
        log.close()
    assert drawn is not None
    return drawn


def points(column: Any) -> Any:
    return numbers(column).reshape(-1, 3)


def test_the_robot_is_where_the_log_says() -> None:
    shown, history = replayed(TROT), measured(TROT).walk.base_history
    time = numbers(shown["time"])
    assert np.diff(time) == pytest.approx(0.04, abs=1e-4)
    since = (history.time - measured(TROT).walk.origin) / 1e9
    assert abs(history.position[0, :2]).max() < 0.5
    for axis, column in enumerate(points(shown["position"]).T):
        wanted = np.interp(time, since, history.position[:, axis])
        assert column == pytest.approx(wanted, abs=1e-3)


def test_a_foot_stands_still_while_it_is_down_and_frames_lead_to_it() -> None:
    """The joints come from transforms, the standing feet from contact points: both must agree."""
    shown = replayed(TROT)
    angles, position = points(shown["angles"]), points(shown["position"])
    limbs = shown["limbs"]
    joints = numbers(limbs["point"]).reshape(len(position), -1, 3)
    tips = [joint for joint in range(joints.shape[1]) if joint not in limbs["parents"]]
    for foot in shown["feet"]:
        down, place = numbers(foot["state"]) == 1, points(foot["point"])
        moved = np.linalg.norm(np.diff(place, axis=0), axis=1)
        assert moved[down[1:] & down[:-1]].max() < 2e-3
        turned = [_world(joints[:, tip], position, angles) for tip in tips]
        away = [np.median(np.linalg.norm(each - place, axis=1)[down]) for each in turned]
        assert min(away) < 3e-3


def _world(point: Any, position: Any, angles: Any) -> Any:
    """Turn points about x by roll, about y by pitch and about z by yaw, and move them."""
    turned = point.copy()
    for axis, angle in enumerate(angles.T):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        a, b = turned[:, first].copy(), turned[:, second].copy()
        turned[:, first] = np.cos(angle) * a - np.sin(angle) * b
        turned[:, second] = np.sin(angle) * a + np.cos(angle) * b
    return position + turned


def test_joint_states_bend_the_legs_as_the_engine_does(tmp_path: Path) -> None:
    """A log without transforms, but with a robot description."""
    log = physics.write_log(tmp_path / "log.mcap", trot())
    found = replayed(log)
    limbs, row = found["limbs"], 10
    joints = numbers(limbs["point"]).reshape(-1, len(limbs["parents"]), 3)[row]
    step = round(numbers(found["time"])[row] / KEPT_S)
    for calf in trot().calf[step, :, :3]:
        assert np.linalg.norm(joints - calf, axis=1).min() < 1e-3


def test_without_contact_points_feet_are_below_the_base(tmp_path: Path) -> None:
    log = walks.write_walk(tmp_path, "geometry_msgs/msg/WrenchStamped", "mcap")
    shown = replayed(log)
    assert shown["limbs"] is None
    assert shown["schematic"]
    assert b"does not tell where the feet are" in page(measured(log), 0, replay=shown)
    odd = replay(measured(TROT).walk, (), frame_times(measured(TROT).walk, ()), None)
    assert odd is not None
    assert (odd["limbs"], odd["schematic"]) == (None, False)
