"""The page as bytes: what it holds, and that nothing of a log gets out of its place."""

import re
from dataclasses import replace
from functools import cache
from html.parser import HTMLParser

import numpy as np
import pytest

from dogbot_logtool.core.arrays import Floats
from dogbot_logtool.core.base.poses import Odometry
from dogbot_logtool.core.contact.contacts import Samples
from dogbot_logtool.core.frames.wrench_frame import WrenchFrame
from dogbot_logtool.core.settings import FootSettings, WalkSettings
from dogbot_logtool.core.walk import Walk
from dogbot_logtool.finding import Finding
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.reader.containers.loss import Damage, Loss
from dogbot_logtool.report.documents import stats_json
from dogbot_logtool.report.page.assets import own
from dogbot_logtool.report.page.index_page import IndexRow, index, index_row
from dogbot_logtool.report.page.render import Beside, page
from tests.analysed import analysed
from tests.measured import LogFacts, measured, measurement_of
from tests.paths import SAMPLE_LOGS
from tests.report.page.page_data import drawings, numbers, trace

TROT = SAMPLE_LOGS / "dogbot_trot.bag"
MB = 1_000_000
GONE = Damage("x", (Loss(250, "gone", 100),))
HOSTILE = "</script><img src=x onerror=alert(1)>%{x}<b>{{7*7}}\u2028\u202e\x1b[31m"
PHASES = (0.0, 0.5, 0.5, 0.0)
PLACES = (("front", "left"), ("front", "right"), ("back", "left"), ("back", "right"))


@cache
def trot() -> tuple[Walk, LogFacts]:
    found = measured(TROT, MeasureOptions())
    return found.walk, LogFacts()


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
    tags = Tags(page(measurement_of(*trot()), 0))
    assert set(tags.loads) == {"href=#findings", "href=#events"}
    assert len(tags.ids) == len(set(tags.ids))
    assert tags.seen.count("script") == 3
    assert tags.seen.count("figure") == 7
    assert tags.seen.count("h1") == 1


def test_the_same_log_gives_the_same_bytes() -> None:
    assert page(measurement_of(*trot()), 0) == page(measurement_of(*trot()), 0)


def test_texts_of_a_log_stay_texts() -> None:
    stats, facts = trot()
    feet = tuple(replace(foot, name=f"{HOSTILE}{row}") for row, foot in enumerate(stats.feet))
    feet = tuple(replace(foot, topic=HOSTILE) for foot in feet)
    topics = tuple(replace(topic, topic=HOSTILE) for topic in stats.topics)
    facts = replace(
        facts,
        path=f"a/{HOSTILE.replace('/', '')}",
        damage=Damage(HOSTILE, (Loss(1, HOSTILE, 2),)),
        findings=[Finding("FEET_UNSURE", HOSTILE)],
    )
    html = page(measurement_of(replace(stats, feet=feet, topics=topics), facts), 100)
    plain = Tags(page(measurement_of(*trot()), 0))
    tags = Tags(html)
    assert "img" not in tags.seen
    assert tags.seen.count("script") == plain.seen.count("script")
    assert b"<img" not in html.replace(b'"<img', b"")  # Plotly's script names the tag
    assert b"\x1b" not in html
    assert "\u202e" not in html.decode()
    assert b"{{7*7}}" in html
    shown = drawings(html)["gait"]["layout"]["yaxis"]["ticktext"]
    assert not [label for label in shown if "<" in label or "%{" in label]


def test_the_policy_names_the_scripts_that_run() -> None:
    html = page(measurement_of(*trot()), 0).decode()
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]*)"', html)
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    beside = page(measurement_of(*trot()), 0, beside=Beside("shared.js", "index.html")).decode()
    assert "script-src 'self' file:; style-src" in beside
    assert len(beside) < MB
    assert "unsafe-inline'; img-src" in policy
    assert "unsafe-inline" not in policy.split(";")[1]


def test_figures_agree_with_the_stats() -> None:
    stats, facts = trot()
    shown = drawings(page(measurement_of(stats, facts), 0))
    for foot in stats.feet:
        force = numbers(trace(shown["loads"], f"{foot.name} |F|")["y"])
        peak_n = float(foot.record.stances.figures.peak_force_n.max())
        assert np.nanmax(force) == pytest.approx(peak_n, abs=2e-3)
        touchdowns = numbers(trace(shown["ground"], foot.name)["x"])
        assert len(touchdowns) == len(foot.record.stances.touchdown)
        bars = [each for each in shown["gait"]["data"] if each["name"] == foot.name]
        known = numbers(bars[1]["base"])
        assert known == pytest.approx(
            np.array(stats.seconds(foot.record.stances.touchdown)), abs=1e-9
        )


def test_the_usual_force_over_the_stride_is_that_of_the_stats() -> None:
    stats, facts = trot()
    document = stats_json(measurement_of(stats, facts))
    cycle = drawings(page(measurement_of(stats, facts), 0))["cycle"]
    for name, foot in document["feet"].items():
        traces = [each for each in cycle["data"] if each["name"] == name]
        keys = ("vertical_over_stride_n", "forward_over_stride_n")
        for found, wanted in zip(traces, (foot[key] for key in keys), strict=True):
            assert numbers(found["y"]) == pytest.approx(np.array(wanted["median"]), abs=2e-3)
            bounds = numbers(found["customdata"]).reshape(-1, 2)
            assert bounds[:, 0] == pytest.approx(np.array(wanted["lower"]), abs=2e-3)


def test_motion_agrees_with_the_stats() -> None:
    stats, facts = trot()
    document, shown = (
        stats_json(measurement_of(stats, facts)),
        drawings(page(measurement_of(stats, facts), 0))["motion"],
    )
    known = {each["name"]: numbers(each["y"]) for each in shown["data"]}
    ranges = {
        "static margin": (document["stability"]["static_margin_m"], 1e3),
        "height over the feet": (document["base"]["height_m"], 1.0),
        "roll": (document["base"]["roll_rad"], 180.0 / np.pi),
        "pitch": (document["base"]["pitch_rad"], 180.0 / np.pi),
    }
    for name, (wanted, scale) in ranges.items():
        assert np.nanmin(known[name]) == pytest.approx(wanted["min"] * scale, rel=1e-3, abs=1e-3)
        assert np.nanmax(known[name]) == pytest.approx(wanted["max"] * scale, rel=1e-3, abs=1e-3)
    speed = document["base"]["forward_speed_mps"]
    assert np.nanmedian(known["speed forward"]) == pytest.approx(speed, rel=0.02)


def test_a_fall_or_a_doubt_is_the_headline() -> None:
    stats, facts = trot()
    start = stats.origin + 2_000_000_000
    fallen = replace(stats, fallen=np.array([[start, stats.end]], np.int64))
    html = page(measurement_of(fallen, facts), 0).decode()
    assert re.search(r'class="verdict unknown">Fall at 2\.0 s<', html)
    assert '<p class="gait">Gait: trot (high confidence' in html
    bands = [
        each["layout"]["shapes"] for each in drawings(html.encode()).values() if each["over_time"]
    ]
    assert all((band[0]["x0"], band[0]["y0"], band[0]["y1"]) == (2.0, 0.0, 1.0) for band in bands)
    html = page(measurement_of(stats, replace(facts, damage=GONE)), 0).decode()
    assert "Data quality: DAMAGED" in html


def test_the_page_tells_date_robot_and_version() -> None:
    stats, facts = trot()
    html = page(measurement_of(stats, replace(facts, start_s=1_760_000_000.0)), 0).decode()
    assert "<dd>2025-10-09 08:53:20 UTC</dd>" in html
    assert "<dt>robot</dt><dd>dogbot</dd>" in html
    assert "(simulation time)" in page(measurement_of(stats, facts), 0).decode()


def test_events_are_listed_and_marked_in_every_figure_over_time() -> None:
    """Of four feet the third is dead and the second silent: their events stand in their rows."""
    html = page(measured(SAMPLE_LOGS / "dogbot_troubled.bag", MeasureOptions()), 0)
    onsets = [float(each) for each in re.findall(rb'"row"><button[^>]* data-from="(.*?)"', html)]
    assert len(onsets) == 2
    assert html.index(b"sensor fault</td>") < html.index(b"gap</td>")
    over_time = {name: each for name, each in drawings(html).items() if each["over_time"]}
    assert set(over_time) == {"gait", "loads", "motion", "commands"}
    for name, each in over_time.items():
        shapes = each["layout"]["shapes"]
        assert [shape["x0"] for shape in shapes] == onsets
        rows = [(shape["yref"], (shape["y0"] + shape["y1"]) / 2.0) for shape in shapes]
        in_rows = {
            "gait": [("y", 2.0), ("y", 1.0)],
            "loads": [("y3 domain", 0.5), ("y2 domain", 0.5)],
        }
        assert rows == in_rows.get(name, [("paper", 0.5)] * 2)
    (label,) = over_time["gait"]["layout"]["annotations"]
    assert label["text"] == "sensor fault"


def luminance(colour: str) -> float:
    """WCAG 2: relative luminance of ``#rrggbb``."""
    parts = [int(colour[start : start + 2], 16) / 255.0 for start in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return float(np.dot([0.2126, 0.7152, 0.0722], linear))


@pytest.mark.parametrize("scheme", [0, 1])
def test_every_line_is_seen_on_light_and_dark(scheme: int) -> None:
    """The contrast of each line and marker with the paper is at least 3:1."""
    paper = luminance(re.findall(r"--paper: (#\w{6})", own("page.css"))[scheme])
    for drawing in drawings(page(measurement_of(*trot()), 0)).values():
        for each in drawing["data"]:
            for part in ("line", "marker"):
                colour = each.get(part, {}).get("color", "")
                if not re.fullmatch("#[0-9a-f]{6}", str(colour)):
                    continue
                low, high = sorted((luminance(colour), paper))
                assert (high + 0.05) / (low + 0.05) >= 3.0, (drawing["name"], colour)


def test_damage_is_marked_where_it_is_in_the_file() -> None:
    stats, facts = trot()
    html = page(measurement_of(stats, replace(facts, damage=GONE)), 1000).decode()
    assert "left:25.000%;width:10.000%" in html
    assert "Data quality: DAMAGED" in html


def samples(foot: int, time: Floats, spikes: Floats) -> Samples:
    """A stride a second, down for 0.6 of it, with peaks of their own at some times."""
    down = (time - PHASES[foot] + 0.003) % 1.0 < 0.6
    force = np.where(down, 196.2 / 4.0 / 0.6, 0.0)
    force[np.searchsorted(time, spikes)] = 500.0 + np.arange(len(spikes))
    down = force > 0.0
    count = len(time)
    up = np.tile([0.0, 0.0, 1.0], (count, 1))
    unknown = np.where(down, 0.0, np.nan)[:, None]
    stamp = np.round(time * 1e9).astype(np.int64) + 10**18
    return Samples(
        foot=np.full(count, foot, np.int64),
        log_time=stamp,
        stamp=stamp,
        in_contact=down,
        force=up * force[:, None],
        in_world=np.zeros(count, np.bool_),
        points=down.astype(np.int64),
        position=np.stack([0.25 * time, time * 0.0 + foot, time * 0.0], axis=1) + unknown,
        normal=up + unknown,
    )


def test_a_page_of_a_long_log_is_small_and_has_every_peak() -> None:
    feet = tuple(
        FootSettings("_".join(place), f"/{foot}", place) for foot, place in enumerate(PLACES)
    )
    settings = WalkSettings(feet, mass_kg=20.0, wrench_frame=WrenchFrame.WORLD)
    time = np.arange(0.0, 1500.0, 0.04)
    spikes = np.arange(30.0, 1500.0, 61.7)
    zero = np.zeros_like(time)
    stamp = np.round(time * 1e9).astype(np.int64) + 10**18
    level = np.stack([zero, zero, zero, zero + 1.0], axis=1)
    place = np.stack([0.25 * time, zero, zero + 0.4], axis=1)
    poses = Odometry(stamp, stamp, place, level, place * 0.0, place * 0.0)
    stats = analysed(settings, [samples(foot, time, spikes) for foot in range(4)], poses)
    html = page(measurement_of(stats, LogFacts("day.bag", "ROS 1 bag", "ros1", 0.0, 1.0, 1)), 0)
    assert len(html) < 2.5 * MB
    shown = drawings(html)
    for name in (place.name for place in feet):
        force = numbers(trace(shown["loads"], f"{name} |F|")["y"])
        peaks = np.sort(force[force > 499.5])
        assert peaks == pytest.approx(500.0 + np.arange(len(spikes)), abs=0.01)
        assert len(force) <= 2 * 8192
    assert b"export has them all" in html


def test_a_log_of_contacts_only_has_a_page_that_says_what_is_missing() -> None:
    feet = (
        FootSettings("left", "/l", has_force=False),
        FootSettings("right", "/r", has_force=False),
    )
    time = np.arange(0.0, 10.0, 0.02)
    seen = [samples(foot, time, np.empty(0)) for foot in range(2)]
    nowhere = np.full_like(seen[0].position, np.nan)
    without = [replace(each, position=nowhere) for each in seen]
    stats = analysed(WalkSettings(feet), without)
    html = page(
        measurement_of(stats, LogFacts("x.mcap", "MCAP", "ros2", None, None, 0)), 0
    ).decode()
    assert "tell contact, not force" in html
    assert "positions are not known" in html
    assert "Gait: walk (high confidence" in html


def test_a_log_without_any_contact_has_a_page() -> None:
    stats = analysed(WalkSettings(()))
    html = page(measurement_of(stats, LogFacts("x.mcap", "MCAP", "ros2", None, None, 0)), 0)
    assert drawings(html) == {}
    assert b"no contacts that could be used" in html


def test_the_index_has_a_row_a_log_and_says_why_one_is_missing() -> None:
    stats, facts = trot()
    rows = [
        index_row(measurement_of(stats, facts), "a b#?.report.html"),
        IndexRow(HOSTILE, error=f"{HOSTILE} is no log"),
    ]
    html = index(rows)
    tags = Tags(html)
    assert tags.loads == ["href=a%20b%23%3F.report.html"]
    assert tags.seen.count("rect") > 4 * 3
    assert "img" not in tags.seen
    assert b"Gait: trot (high confidence" in html
    assert b"is no log" in html
