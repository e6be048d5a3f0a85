"""What the command line can, Python can: the same options, the same results, the same refusals."""

import inspect
import json
import re
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, get_args

import click
import pytest

import dogbot_logtool as dl
from dogbot_logtool import cli
from dogbot_logtool.api.keywords import CHOICES, ConvertKeywords, convert_options, stats_options
from tests.forked_cli import run
from tests.measured import walk_of
from tests.paths import ROOT, TROT, WALK

FUNCTIONS: dict[str, tuple[Callable[..., Any], ...]] = {
    "check": (dl.check,),
    "compare": (dl.compare, dl.compare_gait),
    "convert": (dl.convert,),
    "info": (dl.info,),
    "report": (dl.measure, dl.Walk.report),
    "stats": (dl.measure, dl.Walk.plot),
}
"""What does in Python what a command does."""
OTHER_NAMES = {"output": "target", "no_replay": "replay"}


def options_of(command: str) -> dict[str, str]:
    """The long options of a command, and their names as keywords."""
    words: click.Command = getattr(import_module(f"dogbot_logtool.cli.{command}"), command)
    options = [each for each in words.params if isinstance(each, click.Option)]
    long = [next(name for name in each.opts if name.startswith("--")) for each in options]
    names = [each.removeprefix("--").replace("-", "_") for each in long]
    return {option: OTHER_NAMES.get(name, name) for option, name in zip(long, names, strict=True)}


def keywords_of(function: Callable[..., Any]) -> set[str]:
    """The names of a function's parameters, those that it passes on among them."""
    names = {*inspect.signature(function).parameters} - {"self", "options"}
    if "options" in inspect.signature(function).parameters:
        annotation = inspect.signature(function).parameters["options"].annotation
        (keywords,) = get_args(annotation)
        names |= keywords.__optional_keys__
    return names


def told_exceptions() -> set[tuple[str, str]]:
    """Commands and options of the table in docs/python.md."""
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    rows = text.partition("## What only the command line has")[2].splitlines()
    told = set()
    for row in rows:
        cells = row.split("|")
        if len(cells) == 5:
            for command in re.findall(r"`([a-z]+)`", cells[1]):
                told |= {(command, option) for option in re.findall(r"`(--[a-z-]+)`", cells[2])}
    return told


def test_every_option_is_a_keyword_or_told_as_an_exception() -> None:
    missing = set()
    for command, functions in FUNCTIONS.items():
        known = set().union(*map(keywords_of, functions))
        missing |= {
            (command, each) for each, name in options_of(command).items() if name not in known
        }
    assert missing == told_exceptions()
    others = {each for each in cli._COMMANDS if each not in FUNCTIONS}
    assert others == {"export", "layout", "robots"}


@pytest.mark.parametrize(
    ("command", "options"), [("convert", convert_options), ("stats", stats_options)]
)
def test_defaults_are_the_same(command: str, options: Callable[..., Any]) -> None:
    words: click.Command = getattr(import_module(f"dogbot_logtool.cli.{command}"), command)
    given = words.make_context(command, ["walk.bag"]).params
    known = keywords_of(FUNCTIONS[command][0]) - {"log", "target", "foot", "tare", "join", "topics"}
    assert options({name: given[name] for name in known}) == options({})


def test_the_same_words_measure_the_same() -> None:
    feet = {"front_left": "/dogbot/front_left_contactsensor_state"}
    words = [
        *("--start", 1, "--end", 6, "--contact-on", 12, "--contact-off", 3, "--debounce", 0.03),
        *("--mass", 20, "--time-source", "log", "--forward-axis", "+y", "--wrench-frame", "world"),
        *("--tare", "front_left=1,2,3", "--odom-topic", "/dogbot/odom", "--robot", "dogbot"),
        *("--foot", f"front_left={feet['front_left']}", "--imu", "/dogbot/imu"),
    ]
    printed = json.loads(run("stats", WALK, *words, "--json", "-v").stdout)
    walk = dl.measure(
        WALK,
        start=1,
        end=6,
        contact_on=12,
        contact_off=3,
        debounce=0.03,
        mass=20,
        time_source="log",
        forward_axis="+y",
        wrench_frame="world",
        tare={"front_left": (1, 2, 3)},
        odom_topic="/dogbot/odom",
        robot="dogbot",
        foot=feet,
        imu="/dogbot/imu",
    )
    assert json.loads(json.dumps(walk.stats)) == printed


def test_the_same_words_convert_to_the_same_bytes(tmp_path: Path) -> None:
    words = [
        *("--style", "force", "--encoding", "ros1", "--topics", "/dogbot/*", "--without", "*imu"),
        *("--tf", "always", "--tf-rate", 0, "--scene", "--no-labels", "--events", "--start", 1),
        *("--end", 4, "--compression", "lz4", "--tare", "none", "--jobs", 1),
    ]
    assert run("convert", TROT, *words, "-o", tmp_path / "words.mcap").returncode == 0
    dl.convert(
        TROT,
        tmp_path / "keywords.mcap",
        style="force",
        encoding="ros1",
        topics="/dogbot/*",
        without=["*imu"],
        tf="always",
        tf_rate=0,
        scene=True,
        labels=False,
        events=True,
        start=1,
        end=4,
        compression="lz4",
        tare="none",
    )
    assert (tmp_path / "words.mcap").read_bytes() == (tmp_path / "keywords.mcap").read_bytes()


def test_files_of_one_recording(tmp_path: Path) -> None:
    for name, topics in (("feet.mcap", "*contact*"), ("base.mcap", "/dogbot/odom")):
        dl.convert(WALK, tmp_path / name, topics=[topics], tf="never")
    (tmp_path / "base.bare").touch()
    joined = dl.measure(tmp_path / "feet.mcap", join=[tmp_path / "base.mcap"])
    printed = run(
        "stats", tmp_path / "feet.mcap", tmp_path / "base.mcap", "--join", "--json", "-v"
    ).stdout
    assert json.loads(json.dumps(joined.stats)) == json.loads(printed)
    assert joined.base["x_m"].tolist() == walk_of(WALK).base["x_m"].tolist()


def test_frames_gaits_and_pages(tmp_path: Path) -> None:
    frames = dl.info(TROT, frames=True, jobs=2).frames
    assert frames is not None
    printed = json.loads(run("compare", TROT, WALK, "--gait", "--json").stdout)
    compared = dl.compare_gait(TROT, [WALK])
    assert [each.figure for each in compared.differences] == [
        each["figure"] for each in printed["differences"]
    ]
    run("report", TROT, "--no-replay", "-o", tmp_path / "words.html")
    walk_of(TROT).report(tmp_path / "keywords.html", replay=False)
    assert (tmp_path / "keywords.html").read_bytes() == (tmp_path / "words.html").read_bytes()


def test_a_figure_for_a_paper(tmp_path: Path) -> None:
    walk = walk_of(TROT)
    assert run("stats", TROT, "--figure", tmp_path / "words.svg", "-q").returncode == 0
    start, end = walk.plot(tmp_path / "keywords.svg")
    assert 0.0 < start < end < 8.0
    assert (tmp_path / "keywords.svg").read_bytes() == (tmp_path / "words.svg").read_bytes()
    with pytest.raises(dl.CallError, match="exists already"):
        walk.plot(tmp_path / "keywords.svg")


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"mass": -1.0}, "mass=-1.0: must be a number from 0.001 to 1e+06"),
        ({"mass": float("nan")}, "mass=nan: must be a number"),
        ({"contact_on": "12"}, "contact_on='12': must be a number"),
        ({"start": 1e10}, "must be a number of seconds"),
        ({"jobs": 0}, "jobs=0: must be a whole number from 1 to 256"),
        ({"jobs": 1.5}, "jobs=1.5: must be a whole number"),
        ({"wrench_frame": "earth"}, "must be one of auto, world, link"),
        ({"foot": {"a/b": "/x"}}, "--foot a/b: a foot's name has letters, digits and _ only"),
        ({"tare": {"front_left": (0.0, 1.0)}}, "--tare front_left: must be three numbers"),
        ({"tare": "all"}, "tare='all': must be the force by foot, or 'none'"),
    ],
)
def test_bad_values_are_refused(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(dl.CallError, match=re.escape(sentence)):
        dl.measure(TROT, **options)


@pytest.mark.parametrize("name", ["style", "encoding"])
def test_hints_for_type_checkers_name_the_whole_registry(name: str) -> None:
    assert get_args(ConvertKeywords.__annotations__[name]) == CHOICES[name]


def test_an_option_that_does_not_exist_is_refused() -> None:
    with pytest.raises(TypeError, match="no option 'contact'; there are command, contact_off"):
        dl.measure(TROT, contact=3.0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="no option 'mas'"):
        dl.info(TROT, mas=3.0)  # type: ignore[call-arg]
