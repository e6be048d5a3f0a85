"""The registry of arrow styles: what the design says of each, and that one row adds a style."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.scene.arrows import (
    ArrowCounts,
    ArrowInput,
    Arrows,
    pressure_arrows,
)
from dogbot_logtool.core.scene.styles import ARROW_STYLES, DEFAULT_STYLE, ArrowStyle
from dogbot_logtool.options import ConvertOptions
from tests.paths import SAMPLE_LOGS

TROT = SAMPLE_LOGS / "dogbot_trot.bag"


def test_the_styles_of_the_design() -> None:
    described = {
        name: (style.lifetime_s, style.shaft_diameter_m) for name, style in ARROW_STYLES.items()
    }
    assert described == {
        "classic": (0.0, 0.1),
        "pressure": (0.5, None),
        "force": (0.5, None),
    }
    assert DEFAULT_STYLE == "pressure"


def test_a_row_is_all_that_a_style_needs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def short(given: ArrowInput) -> tuple[Arrows, ArrowCounts]:
        drawn, counts = pressure_arrows(given.samples, given.scale)
        return replace(drawn, length=drawn.length / 2.0), counts

    monkeypatch.setitem(ARROW_STYLES, "short", ArrowStyle("short", "half as long", short))
    options = ConvertOptions(style="short", copy=False, end=0.5)
    done = convert(TROT, tmp_path / "short.mcap", options)
    whole = convert(TROT, tmp_path / "whole.mcap", replace(options, style="pressure"))
    assert done.annotations == whole.annotations
    assert done.annotations["/marker_basic_front_left_foot"] > 100
    assert (tmp_path / "short.mcap").read_bytes() != (tmp_path / "whole.mcap").read_bytes()


def test_the_registry_loads_nothing_heavy() -> None:
    script = "import sys, dogbot_logtool.core.scene.styles; print('numpy' in sys.modules)"
    words = [sys.executable, "-c", script]
    done = subprocess.run(words, capture_output=True, text=True, check=True)  # noqa: S603
    assert done.stdout.strip() == "False"
