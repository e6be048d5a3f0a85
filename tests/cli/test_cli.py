"""The command line: help, wrong calls, exit codes, and the short commands."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import click
import pytest

from dogbot_logtool import __version__
from dogbot_logtool.cli import cli
from dogbot_logtool.extras import install_command
from dogbot_logtool.robot.robot import known_robots
from tests.oracles.small_logs import first_seconds, string_log
from tests.paths import ROOT, TROT, TROUBLED, WALK
from tests.shell import Outcome, Shell

COMMANDS = ("compare", "convert", "info", "layout", "report", "robots", "stats")
SHORT = first_seconds(TROT)


def run_afresh(*words: object, folder: Path) -> Outcome:
    """Run the command in an interpreter of its own."""
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-m", "dogbot_logtool", *map(str, words)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    return Outcome(done.returncode, done.stdout, done.stderr)


@pytest.mark.parametrize("words", [["--help"], ["-h"], *([name, "--help"] for name in COMMANDS)])
def test_help(shell: Shell, words: list[str]) -> None:
    done = shell(*words)
    assert done.code == 0
    assert done.out.startswith("Usage: ")
    assert done.err == ""


def test_the_list_of_commands_fits_a_terminal(
    shell: Shell, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    done = shell("--help")
    listed = done.out.partition("Commands:\n")[2].splitlines()
    assert len(listed) == len(cli.list_commands(click.Context(cli)))
    assert [line for line in listed if "..." in line or len(line) > 80] == []


def test_every_option_says_what_it_takes() -> None:
    """Not what a function of ours or of click is called."""
    group = click.Context(cli)
    for name in cli.list_commands(group):
        command = cli.get_command(group, name)
        assert command is not None
        context = click.Context(command)
        for option in command.params:
            taken = option.make_metavar(context)
            assert "RANGE" not in taken, option.name
            assert "PARSE" not in taken, option.name
            assert "FUNCTION" not in taken, option.name


def test_version(shell: Shell) -> None:
    done = shell("--version")
    assert (done.code, done.err) == (0, "")
    assert __version__ in done.out


def test_help_imports_nothing_heavy(tmp_path: Path) -> None:
    """Neither --help nor a usage error may load numpy, rosbags, rich, mcap or protobuf."""
    script = """\
import contextlib, io, sys
from dogbot_logtool.cli import cli, main
for words in (["--help"], ["--version"], *([c, "--help"] for c in sys.argv[1:]), ["convert"]):
    sys.argv = ["dogbot-logtool", *words]
    with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()):
        main()
heavy = {"numpy", "rosbags", "rich", "mcap", "google.protobuf", "lz4", "zstandard"}
print(sorted(heavy & set(sys.modules)))
"""
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", script, *COMMANDS],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize(
    ("words", "unneeded"),
    [
        (["convert", "--quiet", "-o", "out.mcap"], ["rich", "google.protobuf.json_format"]),
        (["stats", "--json"], ["rich", "mcap", "dogbot_logtool.writer.template"]),
    ],
)
def test_a_command_imports_only_what_it_needs(
    tmp_path: Path, words: list[str], unneeded: list[str]
) -> None:
    """Imports are most of the time that a short log takes."""
    script = """\
import contextlib, sys
from dogbot_logtool.cli import cli, main
with contextlib.suppress(SystemExit):
    main()
print(*sys.modules, file=sys.stderr)
"""
    done = subprocess.run(  # noqa: S603
        [sys.executable, "-c", script, *words, str(SHORT)],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = done.stderr.split()
    assert "numpy" in loaded
    assert [name for name in unneeded if name in loaded] == []


@pytest.mark.parametrize(
    "words",
    [
        [],
        ["nonsense"],
        ["convert"],
        ["info"],
        ["info", "--nonsense", TROUBLED],
        ["convert", TROUBLED, "--style", "loud"],
        ["convert", TROUBLED, "--encoding", "json"],
        ["convert", TROUBLED, "--compression", "gzip"],
        ["convert", TROUBLED, "--jobs", "0"],
        ["convert", TROUBLED, "--tf-rate", "-1"],
        ["convert", TROUBLED, "--tf-rate", "nan"],
        ["convert", TROUBLED, "--tf-rate", "1e-300"],
        ["convert", TROUBLED, "--tf-rate", "1e-11"],
        ["convert", TROUBLED, "--start", "nan"],
        ["convert", TROUBLED, "--end", "inf"],
        ["convert", TROUBLED, "--mass", "0"],
        ["convert", TROUBLED, "--mass", "nan"],
        ["convert", TROUBLED, "--foot", "front_left"],
        ["convert", TROUBLED, "--foot", "front left=/x"],
        ["convert", TROUBLED, "--foot", "front_left=/no/such/topic"],
        ["convert", TROUBLED, "--foot", "front_left=/dogbot/odom"],
        ["convert", TROUBLED, "--odom-topic", "/tf"],
        ["convert", TROUBLED, "--robot", "unicorn"],
        ["convert", TROUBLED, "--robot", "unicorn.toml"],
        ["convert", "no_such.bag"],
        ["convert", "."],
        ["info", "no_such.bag"],
        ["layout", "no_such.bag"],
        ["layout", "--robot", "unicorn"],
        ["robots", "unicorn"],
    ],
    ids=lambda words: " ".join(str(getattr(word, "name", word)) for word in words) or "nothing",
)
def test_wrong_calls_exit_with_2_and_a_sentence(shell: Shell, words: list[object]) -> None:
    done = shell(*words)
    assert done.code == 2
    assert done.out == ""
    assert done.err.strip()
    assert shell.files() == []


def test_what_is_no_log_exits_with_1(shell: Shell) -> None:
    (shell.folder / "walk.bag").write_text("a walk in the park")
    (shell.folder / "empty.bag").write_bytes(b"")
    for name in ("walk.bag", "empty.bag"):
        for command in ("info", "convert", "layout"):
            done = shell(command, name)
            assert (done.code, done.out) == (1, "")
            assert done.err.startswith(f"error: {name}: ")
            assert done.err.count("\n") == 1
    assert shell.files() == ["empty.bag", "walk.bag"]


def test_nothing_to_annotate_exits_with_1_and_lists_topics(shell: Shell) -> None:
    string_log(shell.folder / "log.mcap", [("/said", b"hello")])
    done = shell("convert", "log.mcap")
    assert (done.code, done.out) == (1, "")
    assert "/said  std_msgs/String" in done.err
    assert shell.files() == ["log.mcap"]


# --- info, layout, robots -------------------------------------------------------------------------


def test_info_for_people(shell: Shell) -> None:
    done = shell("info", TROT)
    assert (done.code, done.err) == (0, "")
    for text in ("ROS 1 bag, profile ros1", "lz4", "12,009", "foot front_left", "odometry"):
        assert text in done.out
    assert "base_link  <- added by convert" in done.out


def test_info_json(shell: Shell) -> None:
    done = shell("info", WALK, "--json")
    assert (done.code, done.err) == (0, "")
    told = done.json
    assert (told["container"], told["profile"]) == ("MCAP", "ros2")
    assert told["messages"] == 22510
    topics = {topic["topic"]: topic for topic in told["topics"]}
    assert topics["/dogbot/odom"]["use"] == "odometry"
    assert topics["/dogbot/odom"]["messages"] == 2251
    assert told["frames"]["added"] == ["world", "base_link"]
    assert told["frames"]["parents"]["front_left_hip"] == ["base_link"]


def test_info_with_all_frames(shell: Shell, monkeypatch: pytest.MonkeyPatch) -> None:
    told = shell("info", "--frames", "--json", WALK).json["frames"]
    assert {edge["child"] for edge in told["edges"]} == set(told["parents"])
    for width in ("80", "120"):
        monkeypatch.setenv("COLUMNS", width)
        text = shell("info", "--frames", WALK).out
        assert "static" in text
        assert "added by convert" in text


def test_stats_draws_a_figure(shell: Shell) -> None:
    done = shell("stats", WALK, "--figure", "walk.svg", "--start", 2, "--end", 6, "--json")
    assert done.code == 0
    assert done.json["gait"]["name"] == "walk"
    assert re.search(r"walk.svg: \d\.\d\d to \d\.\d\d s", done.err)
    first = (shell.folder / "walk.svg").read_bytes()
    refused = shell("stats", WALK, "--figure", "walk.svg")
    assert refused.code == 2
    assert "--overwrite" in refused.err
    words = ("--figure", "walk.svg", "--start", 2, "--end", 6, "--overwrite", "--jobs", 3, "-q")
    again = shell("stats", WALK, *words)
    assert (again.code, again.err) == (0, "")
    assert (shell.folder / "walk.svg").read_bytes() == first


@pytest.mark.parametrize(
    ("words", "instead"),
    [
        (["stats", WALK, "--csv"], "use `export --table strides`"),
        (["stats", WALK, "--plot=walk.svg"], "it is --figure now"),
        (["info", WALK, "-o", "tree.gv"], "results go to stdout"),
        (["layout", "--viewer", "rerun"], "Rerun opens the MCAP that `convert` writes"),
    ],
)
def test_an_option_that_is_gone_says_what_to_use(
    shell: Shell, words: list[object], instead: str
) -> None:
    done = shell(*words)
    assert (done.code, done.out, shell.files()) == (2, "", [])
    assert f"is gone: {instead}." in done.err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([TROT, WALK, "--figure", "both.pdf"], "call it for each"),
        ([WALK, "--figure", "walk.eps"], "must end in one of .pdf, .png, .svg"),
        ([WALK, "--figure", "none/walk.pdf"], "no such folder"),
    ],
)
def test_figures_that_cannot_be_drawn(shell: Shell, words: list[object], told: str) -> None:
    refused = shell("stats", *words)
    assert refused.code == 2
    assert told in refused.err
    assert shell.files() == []


def test_without_matplotlib_it_is_said_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    absent = tmp_path / "absent"
    absent.mkdir()
    (absent / "matplotlib.py").write_text("raise ImportError")
    root = str(ROOT)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(absent), root]))
    refused = run_afresh("stats", WALK, "--figure", "walk.pdf", folder=tmp_path)
    assert refused.code == 1
    assert install_command("plot") in refused.err
    assert run_afresh("stats", SHORT, "-q", folder=tmp_path).code == 0


def test_info_of_several_logs(shell: Shell) -> None:
    done = shell("info", SHORT, "nothing.bag", TROUBLED, "--json", "--jobs", 1)
    assert done.code == 2
    assert [bool(one.get("error")) for one in done.json] == [False, True, False]
    assert done.err == "error: 1 of 3 logs could not be done\n  nothing.bag  no such file\n"


@pytest.mark.parametrize(
    ("words", "package"),
    [
        (("info", "s3://lab/walk.bag"), "upath"),
        (("info", "@s3://lab/list.txt"), "upath"),
        (("stats", TROT, "--scheduler", "tcp://x:1"), "distributed"),
        (("export", TROT, "--dataset", "walks"), "pyarrow"),
    ],
)
def test_what_an_extra_brings_is_asked_for(
    shell: Shell, monkeypatch: pytest.MonkeyPatch, words: Sequence[object], package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    dataset = ("cli.dataset", "report.dataset")
    for module in ("run.cluster", *dataset):
        monkeypatch.delitem(sys.modules, f"dogbot_logtool.{module}", raising=False)
    done = shell(*words)
    assert (done.code, done.out) == (1, "")
    assert done.err.endswith(f"not installed: {install_command('fleet')}\n")
    assert shell.files() == []


def test_layout(shell: Shell) -> None:
    done = shell("layout")
    assert (done.code, done.err) == (0, "")
    assert set(done.json) >= {"configById", "layout"}
    of_log = shell("layout", TROUBLED).json
    assert of_log["layout"] == done.json["layout"]
    assert of_log["configById"].keys() == done.json["configById"].keys()
    assert shell("layout", "-o", "x.json") == Outcome(0, "", "")
    assert json.loads((shell.folder / "x.json").read_text()) == done.json
    assert shell("layout", "-o", "x.json").code == 2
    assert shell("layout", "-o", "x.json", "--overwrite").code == 0
    assert shell.files() == ["x.json"]


def test_robots(shell: Shell) -> None:
    done = shell("robots")
    assert done.code == 0
    assert tuple(line.split()[0] for line in done.out.splitlines()) == known_robots()
    assert set(shell("robots", "--json").json) == set(known_robots())
    toml = shell("robots", "dogbot")
    assert "[feet.front_left]" in toml.out
    (shell.folder / "mine.toml").write_text(toml.out)
    assert shell("convert", TROUBLED, "--robot", "mine.toml", "-q").code == 0
