"""The page in a real browser: it draws itself, zooms as one, tells values, and asks for nothing."""

import json
import shutil
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from selenium.webdriver import Chrome
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from dogbot_logtool.commands.report import Reports
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.io.targets import Output
from dogbot_logtool.pipeline.options import StatsOptions, TopicOptions
from dogbot_logtool.report.stats_json import stats_json
from tests.oracles import walks
from tests.paths import SAMPLE_LOGS

TROT = SAMPLE_LOGS / "dogbot_trot.bag"
BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
SWITCHES: Final = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--hide-scrollbars",
    "--window-size=1300,1000",
)
OVER_TIME: Final = ("gait", "loads", "recording")
pytestmark = pytest.mark.skipif(
    not (BROWSER and DRIVER), reason="no chromium with chromedriver on this machine"
)


@dataclass(frozen=True, slots=True)
class Window:
    """A browser, and what a reader does with it."""

    driver: Chrome

    def open(self, path: Path, *, width: int = 1300, scheme: str = "light") -> None:
        """Open a page from disk and wait until it has drawn itself."""
        size = {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})
        self.driver.get_log("performance")
        self.driver.get(path.as_uri())
        WebDriverWait(self.driver, 30, 0.05).until(
            lambda driver: driver.execute_script("return document.documentElement.dataset.drawn")
        )

    def run(self, script: str, *words: object) -> Any:
        return self.driver.execute_script(script, *words)

    def complaints(self) -> list[str]:
        """Everything that the console was told, scripts that failed and policies included."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

    def requests(self) -> set[str]:
        """Every address that was asked for since the page was opened."""
        events = [json.loads(entry["message"]) for entry in self.driver.get_log("performance")]
        messages = [event["message"] for event in events]
        return {
            message["params"]["request"]["url"]
            for message in messages
            if message["method"] == "Network.requestWillBeSent"
        }

    def ranges(self) -> list[list[float]]:
        """The time that each figure over time shows."""
        script = "return document.getElementById(arguments[0])._fullLayout.xaxis.range"
        return [self.run(script, name) for name in OVER_TIME]

    def pixel(self, figure: str, x: float, y: float, axis: str = "yaxis") -> tuple[int, int]:
        """Where a point of a figure is, from the middle of its box."""
        script = """
            const node = document.getElementById(arguments[0]), full = node._fullLayout;
            node.scrollIntoView({block: "center"});
            const box = node.getBoundingClientRect(), xa = full.xaxis, ya = full[arguments[3]];
            return [xa._offset + xa.d2p(arguments[1]) - box.width / 2,
                    ya._offset + ya.d2p(arguments[2]) - box.height / 2];
        """
        across, down = self.run(script, figure, x, y, axis)
        return round(across), round(down)

    def hover(self, figure: str, place: tuple[int, int]) -> str:
        """Move the mouse there; return what the figure says."""
        node = self.driver.find_element("id", figure)
        ActionChains(self.driver, duration=20).move_to_element_with_offset(node, *place).perform()
        script = (
            "return document.getElementById(arguments[0]).querySelector('.hoverlayer').textContent"
        )
        WebDriverWait(self.driver, 5, 0.05).until(lambda _: self.run(script, figure))
        return str(self.run(script, figure))


@pytest.fixture(scope="session")
def window() -> Iterator[Window]:
    options = Options()
    options.binary_location = BROWSER or ""
    for switch in SWITCHES:
        options.add_argument(switch)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = Chrome(options=options, service=Service(DRIVER))
    try:
        yield Window(driver)
    finally:
        driver.quit()


@pytest.fixture(scope="session")
def trot_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("page") / "trot.html"
    Reports([TROT], Output(target, is_folder=False), StatsOptions(), overwrite=False).write(TROT)
    return target


@pytest.fixture(scope="session")
def trot_json() -> Any:
    measured = measure(TROT, StatsOptions())
    return json.loads(json.dumps(stats_json(measured.stats, measured.facts)))


MARKS: Final = {
    "gait": ".barlayer .point path",
    "loads": ".scatterlayer path.js-line",
    "ground": ".scatterlayer .points path.point",
    "clock": ".polarlayer path.js-line",
    "recording": ".barlayer .point path",
}


def test_every_figure_is_drawn_and_nothing_is_asked_for(window: Window, trot_page: Path) -> None:
    window.open(trot_page)
    script = """
        const marks = [...document.getElementById(arguments[0]).querySelectorAll(arguments[1])];
        return marks.filter((mark) => {
            const box = mark.getBBox();
            return box.width + box.height > 2;
        }).length;
    """
    drawn = {name: window.run(script, name, marks) for name, marks in MARKS.items()}
    assert drawn["gait"] == 4 * 7 + 2
    assert drawn["loads"] >= 4
    assert drawn["ground"] >= 4 * 7
    assert drawn["clock"] == 4
    assert drawn["recording"] == 5
    assert window.complaints() == []
    assert window.requests() == {trot_page.as_uri()}


def test_time_is_one_for_all_figures(window: Window, trot_page: Path) -> None:
    window.open(trot_page)
    whole = window.ranges()
    assert whole[0] == whole[1] == whole[2]

    node = window.driver.find_element("id", "loads")
    start, end = window.pixel("loads", 2.0, 60.0), window.pixel("loads", 4.0, 60.0)
    drag = ActionChains(window.driver, duration=50).move_to_element_with_offset(node, *start)
    drag.click_and_hold().move_by_offset(end[0] - start[0], 0).release().perform()
    WebDriverWait(window.driver, 5, 0.05).until(lambda _: window.ranges()[0] != whole[0])
    time.sleep(0.2)
    shown = window.ranges()
    assert shown[1] == pytest.approx([2.0, 4.0], abs=0.05)
    assert shown[0] == pytest.approx(shown[1])
    assert shown[2] == pytest.approx(shown[1])

    window.driver.find_element("id", "gait").send_keys(Keys.ARROW_RIGHT)
    WebDriverWait(window.driver, 5, 0.05).until(lambda _: window.ranges()[2] != shown[2])
    assert window.ranges()[1] == pytest.approx([each + 0.5 for each in shown[1]], abs=0.05)

    window.driver.find_element("css selector", "button[data-do=whole]").click()
    WebDriverWait(window.driver, 5, 0.05).until(lambda _: window.ranges() == whole)
    assert "0.00 to 8.00 s" in window.driver.find_element("id", "shown").text


def test_a_hover_tells_what_the_stats_say(window: Window, trot_page: Path, trot_json: Any) -> None:
    window.open(trot_page)
    for axis, (name, foot) in zip(
        ("yaxis", "yaxis2", "yaxis3", "yaxis4"), trot_json["feet"].items(), strict=True
    ):
        script = """
            const node = document.getElementById("loads");
            const trace = node._fullData.find((each) => each.name === arguments[0]);
            const force = Array.from(trace.y), top = force.indexOf(Math.max(...force));
            const at = trace.x[top];
            Plotly.relayout(node, {"xaxis.range": [at - 0.1, at + 0.1]});
            return at;
        """
        at = window.run(script, f"{name} |F|")
        peak = foot["peak_force_n"]["max"]
        said = window.hover("loads", window.pixel("loads", at, peak, axis))
        weights = foot["peak_force_bw"]["max"]
        assert f"{name} |F| : {peak:.1f} N ({weights:.2f} BW)" in said
        assert f"{at:.3f} s" in said

    whole = [0.0, trot_json["log"]["duration_s"]]
    window.run("return Plotly.relayout('gait', {'xaxis.range': arguments[0]})", whole)
    foot = trot_json["feet"]["back_left"]
    touchdown = next(each for each in foot["touchdown_s"] if each > 1.0)
    liftoff = next(each for each in foot["liftoff_s"] if each > touchdown)
    said = window.hover("gait", window.pixel("gait", (touchdown + liftoff) / 2.0, 2.0))
    assert f"down for {liftoff - touchdown:.3f} s" in said
    assert f"from {touchdown:.3f} to {liftoff:.3f} s" in said


@pytest.mark.parametrize(("width", "scheme"), [(400, "dark"), (1600, "light")])
def test_nothing_is_wider_than_the_screen_and_colours_follow_the_reader(
    window: Window, trot_page: Path, width: int, scheme: str
) -> None:
    window.open(trot_page, width=width, scheme=scheme)
    assert window.run("return document.documentElement.scrollWidth") <= width
    ink = window.run("return getComputedStyle(document.querySelector('#loads text')).fill")
    paper = window.run("return getComputedStyle(document.body).backgroundColor")
    brightness = [
        float(np.mean([int(each) for each in colour[4:-1].split(",")])) for colour in (ink, paper)
    ]
    assert (brightness[0] > 200 and brightness[1] < 50) == (scheme == "dark")
    assert (brightness[0] < 50 and brightness[1] > 200) == (scheme == "light")
    assert window.complaints() == []


HOSTILE: Final = "</script><img src=x onerror=window.harmed=1><b>%{x}"


class HostileWalk(walks.Walk):
    """Frames whose names would be markup."""

    def header(self, sample: int, frame: str) -> Any:
        return super().header(sample, f"/{HOSTILE}{frame}")


def test_names_in_a_log_are_never_markup(window: Window, tmp_path: Path) -> None:
    kind = "gazebo_msgs/msg/ContactsState"
    walk = HostileWalk(2)
    renamed = [
        walks.Entry(f"/{HOSTILE}{each.topic}", each.kind, each.log_time, each.data)
        for each in walk.messages(kind)
    ]
    walks.write_mcap(tmp_path / "walk.mcap", walk, renamed)
    feet = {f"{HOSTILE}{leg}": f"/{HOSTILE}{walks.foot_topic(kind, leg)}" for leg in walks.LEGS}
    options = StatsOptions(topics=TopicOptions(None, f"/{HOSTILE}/odom", feet, walks.MASS_KG))
    log, target = tmp_path / "walk.mcap", tmp_path / "walk.html"
    Reports([log], Output(target, is_folder=False), options, overwrite=False).write(log)

    window.open(target)
    assert window.run("return window.harmed") is None
    assert window.run("return document.querySelectorAll('img, .plot b').length") == 0
    assert HOSTILE in window.driver.find_element("css selector", "tbody th").text
    assert HOSTILE in window.run(
        "return document.querySelector('#gait .yaxislayer-above').textContent"
    )
    said = window.hover("gait", window.pixel("gait", 2.0, 0.0))
    assert "<b>%{x}" in said
    assert window.complaints() == []
    assert window.requests() == {target.as_uri()}
