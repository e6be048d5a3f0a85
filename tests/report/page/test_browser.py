"""The page in a real browser: it draws itself, zooms as one, tells values, and asks for nothing."""

import base64
import csv
import io
import json
import shutil
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from pypdf import PdfReader
from selenium.webdriver import Chrome
from selenium.webdriver.chrome.options import Options
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

import dogbot_logtool as dl
from dogbot_logtool.report.documents import stats_json
from tests import forked_cli
from tests.measured import measured
from tests.paths import TROT, TROUBLED

BROWSER, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
SWITCHES: Final = "--headless=new --no-sandbox --disable-gpu --hide-scrollbars --no-first-run"
OVER_TIME: Final = ("gait", "loads", "motion", "commands")


@dataclass(frozen=True, slots=True)
class Window:
    """A browser, and what a reader does with it."""

    driver: Chrome

    def open(self, path: Path, *, width: int = 1300, scheme: str = "light") -> None:
        """Open a page from disk and wait until it has drawn itself."""
        self.show_as(width, scheme)
        self.driver.get(path.as_uri())
        WebDriverWait(self.driver, 30, 0.05).until(
            lambda driver: driver.execute_script("return document.documentElement.dataset.drawn")
        )

    def show_as(self, width: int, scheme: str) -> None:
        """Give the window a width and the reader a scheme."""
        size = {"width": width, "height": 1000, "deviceScaleFactor": 1, "mobile": False}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        features = [{"name": "prefers-color-scheme", "value": scheme}]
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": features})

    def brightness(self) -> tuple[bool, bool]:
        """Whether the paper is bright, and whether the text of a figure is."""
        script = "return getComputedStyle(document.querySelector(arguments[0]))[arguments[1]]"
        paper = self.run(script, "body", "backgroundColor")
        ink = self.run(script, "#loads text", "fill")
        parts = [[int(each) for each in colour[4:-1].split(",")] for colour in (paper, ink)]
        return float(np.mean(parts[0])) > 200, float(np.mean(parts[1])) > 200

    def run(self, script: str, *words: object) -> Any:
        return self.driver.execute_script(script, *words)

    def complaints(self) -> list[str]:
        """Everything that the console was told, scripts that failed and policies included."""
        return [entry["message"] for entry in self.driver.get_log("browser")]

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


REPLAY_TIME: Final = "return parseFloat(document.getElementById('scrub').ariaValueText)"
pytestmark = pytest.mark.skipif(
    not (BROWSER and DRIVER), reason="no chromium with chromedriver on this machine"
)


@pytest.fixture(scope="session")
def window() -> Iterator[Window]:
    options = Options()
    options.binary_location = BROWSER or ""
    for switch in SWITCHES.split():
        options.add_argument(switch)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = Chrome(options=options, service=Service(DRIVER))
    try:
        yield Window(driver)
    finally:
        driver.quit()


@pytest.fixture(scope="session")
def trot_page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("page") / "trot.html"
    dl.measure(TROT).report(target)
    return target


@pytest.fixture(scope="session")
def trot_json() -> Any:
    return json.loads(json.dumps(stats_json(measured(TROT))))


MARKS: Final = {
    "gait": ".barlayer .point path",
    "loads": ".scatterlayer path.js-line",
    "ground": ".scatterlayer .points path.point",
    "motion": ".scatterlayer path.js-line",
    "commands": ".scatterlayer path.js-line",
    "cycle": ".scatterlayer path.js-line",
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
    assert drawn["motion"] >= 5
    assert drawn["commands"] == 6
    assert drawn["cycle"] >= 8
    assert drawn["loads"] >= 4
    assert drawn["ground"] >= 4 * 7
    script = """
        const wrong = (each) => Plotly.validate(each.data, each.layout) ?? [];
        return JSON.parse(document.getElementById("drawings").textContent).flatMap(wrong)
            .filter((each) => ["schema", "value"].includes(each.code)).map((each) => each.msg);
    """
    assert window.run(script) == []
    # The page's policy lets nothing be asked for, and the console tells what would have been.
    assert window.complaints() == []


def test_time_is_one_for_all_figures(window: Window, trot_page: Path) -> None:
    window.open(trot_page)
    whole = window.ranges()
    assert whole[0] == whole[1] == whole[2] == whole[3]

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
    foot = trot_json["feet"]["front_right"]
    script = """
        const node = document.getElementById("loads");
        const trace = node._fullData.find((each) => each.name === "front_right |F|");
        const force = Array.from(trace.y), top = force.indexOf(Math.max(...force));
        const at = trace.x[top];
        Plotly.relayout(node, {"xaxis.range": [at - 0.1, at + 0.1]});
        return at;
    """
    at, peak = window.run(script), foot["peak_force_n"]["max"]
    said = window.hover("loads", window.pixel("loads", at, peak, "yaxis2"))
    assert f"front_right |F| : {peak:.1f} N ({foot['peak_force_bw']['max']:.2f} BW)" in said
    assert f"{at:.3f} s" in said

    whole = [0.0, trot_json["log"]["duration_s"]]
    window.run("return Plotly.relayout('gait', {'xaxis.range': arguments[0]})", whole)
    foot = trot_json["feet"]["back_left"]
    touchdown = next(each for each in foot["touchdown_s"] if each > 1.0)
    liftoff = next(each for each in foot["lift_off_s"] if each > touchdown)
    said = window.hover("gait", window.pixel("gait", (touchdown + liftoff) / 2.0, 2.0))
    assert f"down for {liftoff - touchdown:.3f} s" in said
    assert f"from {touchdown:.3f} to {liftoff:.3f} s" in said

    # The mouse over one figure puts the cursor of every figure at the same time.
    window.hover("loads", window.pixel("loads", 3.0, 60.0))
    at = float(window.driver.find_element("id", "cursor").text.split()[1])
    assert at == pytest.approx(3.0, abs=0.02)
    script = """
        const node = document.getElementById(arguments[0]);
        const mark = node.querySelector(".mark.line"), axis = node._fullLayout.xaxis;
        const shift = mark.getBoundingClientRect().left - node.getBoundingClientRect().left;
        return axis.p2d(shift - axis._offset);
    """
    for name in OVER_TIME:
        assert window.run(script, name) == pytest.approx(at, abs=0.02), name
    shown = window.run(
        "return [...document.querySelectorAll('#cycle .mark.dot, #ground .mark.dot')]"
        ".filter((mark) => !mark.hidden).length"
    )
    assert shown == 8 + 1


CUT_OFF: Final = """
    const cut = [];
    const width = document.documentElement.clientWidth;
    for (const node of document.querySelectorAll("body *")) {
        const box = node.getBoundingClientRect(), style = getComputedStyle(node);
        if (!box.width || !box.height || style.visibility === "hidden") continue;
        if (node.closest("svg, script, .mark, .skip") && !node.matches("svg text")) continue;
        if (node.matches("svg text, svg") && node.closest(".hoverlayer, .draglayer")) continue;
        if (box.right > width + 1 || box.left < -1) cut.push(node.outerHTML.slice(0, 90));
        if (node.scrollWidth > node.clientWidth + 1 && style.overflowX !== "visible")
            cut.push("scrolls: " + node.outerHTML.slice(0, 90));
    }
    return cut;
"""


def _looks(window: Window, wanted: tuple[bool, bool], _: Chrome) -> bool:
    return window.brightness() == wanted


@pytest.mark.slow
def test_nothing_is_cut_off_and_colours_follow_the_reader(window: Window, trot_page: Path) -> None:
    """Whatever the width and the scheme, also when they change while the page is open."""
    window.open(trot_page, width=1600)
    for width, scheme in ((1600, "light"), (400, "dark"), (1024, "light"), (1600, "dark")):
        window.show_as(width, scheme)
        WebDriverWait(window.driver, 10, 0.1).until(lambda _: window.run(CUT_OFF) == [])
        assert window.run("return document.documentElement.scrollWidth") <= width
        wanted = (scheme == "light", scheme == "dark")
        WebDriverWait(window.driver, 5, 0.1).until(partial(_looks, window, wanted))
    assert window.complaints() == []


@pytest.mark.slow
def test_it_prints_whole_from_a_wide_window(window: Window, trot_page: Path) -> None:
    """Every figure over time ends with its last tick, on the paper."""
    window.open(trot_page, width=1920, scheme="dark")
    paper = window.driver.execute_cdp_cmd("Page.printToPDF", {"printBackground": True})
    places: list[tuple[str, float, float]] = []
    for page in PdfReader(io.BytesIO(base64.b64decode(paper["data"]))).pages:

        def visit(
            text: str, cm: Any, tm: Any, *_: object, width: float = page.mediabox.width
        ) -> None:
            x = tm[4] * cm[0] + tm[5] * cm[2] + cm[4]
            places.append((text.strip(), x, width))

        page.extract_text(visitor_text=visit)
    assert all(0.0 < x < width for text, x, width in places if text)
    words = "".join(text for text, _, _ in places).replace("\n", "")
    assert words.count("8 s") >= len(OVER_TIME)
    window.open(trot_page)
    assert window.run("return document.getElementById('loads')._fullLayout.width") > 1000


def test_data_are_saved_as_csv(window: Window, trot_page: Path, trot_json: Any) -> None:
    window.open(trot_page)
    script = """
        const done = arguments[arguments.length - 1];
        URL.createObjectURL = (blob) => { blob.text().then(done); return "#"; };
        document.querySelector(`button[data-csv=${arguments[0]}]`).click();
    """
    run = window.driver.execute_async_script
    rows = list(csv.DictReader(run(script, "loads").splitlines()))
    for name, foot in trot_json["feet"].items():
        force = [float(row["value"]) for row in rows if row["series"] == f"{name} |F|"]
        assert max(force) == pytest.approx(foot["peak_force_n"]["max"], rel=1e-6)
    bars = list(csv.DictReader(run(script, "gait").splitlines()))
    starts = [float(row["start_s"]) for row in bars if row["series"] == "front_left"]
    assert starts == pytest.approx(trot_json["feet"]["front_left"]["touchdown_s"], abs=1e-6)
    steps = list(csv.DictReader(run(script, "steps").splitlines()))
    assert [row["foot"] for row in steps] == list(trot_json["feet"])
    assert window.complaints() == []


@pytest.mark.slow
def test_pages_share_a_script_and_the_index_sorts(window: Window, tmp_path: Path) -> None:
    """The page of a log with events steps from one to the next."""
    logs = [TROT, TROUBLED]
    assert forked_cli.run("report", *logs, "-o", tmp_path).returncode == 0
    window.open(tmp_path / "dogbot_troubled.report.html")
    assert window.run("return document.querySelectorAll('.plot .main-svg').length") > 7
    assert window.run("return document.getElementById('alone')") is None
    onsets = window.run(
        "return [...document.querySelectorAll('#events button[data-from]')]"
        ".map((button) => Number(button.dataset.from))"
    )
    assert len(window.driver.find_elements("css selector", "#ticks i")) == len(onsets) == 2
    window.driver.find_element("css selector", "button[data-replay=forth]").click()
    assert window.run(REPLAY_TIME) == pytest.approx(onsets[1], abs=1e-3)
    assert "gap" in window.driver.find_element("id", "happens").text

    window.driver.find_element("link text", "All logs").click()
    names = "return [...document.querySelectorAll('tbody th')].map((cell) => cell.innerText)"
    shown = ["dogbot_trot.bag", "dogbot_troubled.bag"]
    assert window.run(names) == shown
    heading = window.driver.find_element("xpath", "//thead//button[text()='duration s']")
    heading.click()
    assert window.run(names) == shown[::-1]
    heading.click()
    assert window.run(names) == shown
    assert window.complaints() == []


@pytest.mark.slow
def test_the_walk_is_replayed(window: Window, trot_page: Path, trot_json: Any) -> None:
    """Playing moves robot, slider and cursors; the view follows, turns, and steps to events."""
    window.open(trot_page, scheme="dark")
    picture = "return document.getElementById('replay').toDataURL()"
    drawn = "return Number(document.getElementById('replay').dataset.drawn)"
    seek = """
        const scrub = document.getElementById("scrub");
        scrub.value = arguments[0] * 25;  // frames a second
        scrub.dispatchEvent(new Event("input"));
    """
    before = window.run(picture)
    window.driver.find_element("id", "play").click()
    count = window.run(drawn)
    WebDriverWait(window.driver, 20, 0.05).until(lambda _: window.run(REPLAY_TIME) > 0.5)
    window.driver.find_element("id", "play").click()
    assert window.run(drawn) > count + 3
    assert window.run(picture) != before
    shown = window.driver.find_element("id", "cursor").text
    assert float(shown.split()[1]) == pytest.approx(window.run(REPLAY_TIME), abs=2e-3)

    window.run(seek, 3.0)
    still = window.run(picture)
    canvas = window.driver.find_element("id", "replay")
    ActionChains(window.driver).drag_and_drop_by_offset(canvas, 80, 20).perform()
    assert window.run(picture) != still
    canvas.send_keys(Keys.ARROW_RIGHT)
    assert window.run(REPLAY_TIME) == pytest.approx(3.04, abs=1e-3)
    window.hover("gait", window.pixel("gait", 5.0, 1.0))
    assert window.run(REPLAY_TIME) == pytest.approx(5.0, abs=0.02)
    last = float(window.driver.find_element("id", "scrub").get_attribute("max") or 0)
    assert trot_json["log"]["duration_s"] == pytest.approx(last / 25, abs=0.05)
    assert window.complaints() == []
