"""Chromium, and what a reader of a page does in it."""

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from selenium.webdriver import Chrome
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.support.ui import WebDriverWait

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
OVER_TIME: Final = ("gait", "loads", "motion", "commands")


@dataclass(frozen=True, slots=True)
class Window:
    """A browser, and what a reader does with it."""

    driver: Chrome

    def open(self, path: Path, *, width: int = 1300, scheme: str = "light") -> None:
        """Open a page from disk and wait until it has drawn itself."""
        self.show_as(width, scheme)
        self.driver.get_log("performance")
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
