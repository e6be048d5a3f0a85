"""The command line: exit codes, what goes to stdout and stderr, signals, start-up."""

import contextlib
import json
import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import click
import pyte
import pytest
from mcap.reader import make_reader

from dogbot_logtool import __version__
from dogbot_logtool.cli import cli
from dogbot_logtool.extras import install_command
from dogbot_logtool.robot import known_robots
from tests import forked_cli
from tests.oracles.small_logs import first_seconds, odometry_log, string_log
from tests.paths import ROOT, TROT, TROUBLED, WALK
from tests.shell import Outcome, Shell
from tests.unfinished import unfinished

COMMANDS = ("compare", "convert", "info", "layout", "report", "robots", "stats")
SHORT = first_seconds(TROT)
MAGIC = b"\x89MCAP0\r\n"


def run(*words: object, folder: Path) -> Outcome:
    """Run the command as a process of its own."""
    done = forked_cli.run(*words, folder=folder)
    return Outcome(done.returncode, done.stdout, done.stderr)


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


# --- Words ----------------------------------------------------------------------------------------


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
        (["convert", "--quiet", "-o", "out.mcap"], ["rich", "dogbot_logtool.core.statistics"]),
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


# --- convert --------------------------------------------------------------------------------------


def test_convert_says_what_it_did_on_stderr_only(shell: Shell) -> None:
    done = shell("convert", TROUBLED)
    assert (done.code, done.out) == (0, "")
    assert shell.files() == ["dogbot_troubled.annotated.mcap"]
    assert "dogbot_troubled.annotated.mcap: 3,659 recorded messages and 4,710 ann" in done.err
    assert "warning" in done.err
    assert "note" in done.err


def test_verbose_lists_annotations(shell: Shell) -> None:
    done = shell("convert", TROUBLED, "-v", "-o", "x.mcap")
    assert "501  /load/front_left" in done.err
    assert "/load" not in shell("convert", TROUBLED, "-o", "y.mcap").err


def test_quiet_says_nothing(shell: Shell) -> None:
    done = shell("convert", TROUBLED, "--quiet", "-o", "x.mcap")
    assert done == Outcome(0, "", "")
    assert shell.files() == ["x.mcap"]


def test_convert_json(shell: Shell) -> None:
    done = shell("convert", TROUBLED, "--json", "--quiet", "-o", "x.mcap", "--style", "force")
    assert (done.code, done.err) == (0, "")
    told = done.json
    assert told["tool"] == {"name": "dogbot-logtool", "version": __version__}
    assert (told["input"], told["output"]) == (str(TROUBLED), "x.mcap")
    assert (told["style"], told["encoding"], told["robot"]) == ("force", "foxglove", "dogbot")
    assert told["topics"]["odometry"] == ["/dogbot/odom"]
    assert set(told["topics"]["feet"]) == {"front_left", "front_right", "back_left", "back_right"}
    assert told["frames"] == {"world": "world", "base": "base_link"}
    assert told["messages"] == {"read": 3659, "copied": 3659}
    with (shell.folder / "x.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    counts = {
        summary.channels[number].topic: count
        for number, count in summary.statistics.channel_message_counts.items()
    }
    assert told["annotations"] == {topic: counts[topic] for topic in told["annotations"]}
    assert sum(counts.values()) == 3659 + sum(told["annotations"].values())
    assert told["skipped"]["bad_poses"] == 1
    assert {finding["code"] for finding in told["findings"]} >= {"W_ZERO_STAMPS"}
    assert told["damage"] == {"messages": 0, "bytes": 0, "places": []}


def test_several_logs_go_into_a_directory(shell: Shell) -> None:
    (shell.folder / "out").mkdir()
    (shell.folder / "bad.bag").write_text("no bag")
    done = shell("convert", TROUBLED, "bad.bag", WALK, "-o", "out", "--json", "-q")
    assert done.code == 1
    first, bad, last = done.json
    assert first["output"] == "out/dogbot_troubled.annotated.mcap"
    assert bad["input"] == "bad.bag"
    assert bad["error"].startswith("bad.bag: ")
    assert last["messages"]["copied"] == 22510
    names = sorted(file.name for file in (shell.folder / "out").iterdir())
    assert names == ["dogbot_troubled.annotated.mcap", "dogbot_walk.annotated.mcap"]
    assert shell("convert", TROUBLED, WALK, "-o", "nowhere.mcap").code == 2


def test_damage_exits_with_3_or_with_1_when_strict(shell: Shell) -> None:
    log = odometry_log(shell.folder / "log.mcap", "/odom", cut=1)
    done = shell("convert", log, "-o", "x.mcap", "--json")
    assert done.code == 3
    assert done.json["damage"]["messages"] == 1
    assert "damage" in done.err
    assert "/odom" in done.err
    done = shell("convert", log, "-o", "strict.mcap", "--strict")
    assert (done.code, done.out) == (1, "")
    assert "--strict" in done.err
    assert shell.files() == ["log.mcap", "x.mcap"]


@pytest.mark.parametrize("command", ["info", "convert"])
def test_a_log_that_is_cut_off_exits_with_3(shell: Shell, command: str) -> None:
    for log in (TROT, WALK):
        cut = shell.folder / log.name
        cut.write_bytes(log.read_bytes()[:-1000])
        done = shell(command, cut, "--json")
        assert done.code == 3
        assert done.json["damage"]["places"]
    assert not [name for name in shell.files() if name.endswith(".part")]


def test_an_output_is_not_overwritten_unasked(shell: Shell) -> None:
    target = shell.folder / "x.mcap"
    target.write_text("precious")
    done = shell("convert", TROUBLED, "-o", "x.mcap")
    assert (done.code, done.out) == (2, "")
    assert "--overwrite" in done.err
    assert target.read_text() == "precious"
    assert shell("convert", TROUBLED, "-o", "x.mcap", "--overwrite", "-q").code == 0
    assert target.read_bytes().endswith(MAGIC)
    assert shell.files() == ["x.mcap"]


def test_the_input_is_never_the_output(shell: Shell) -> None:
    log = shell.folder / "log.mcap"
    log.write_bytes(WALK.read_bytes())
    (shell.folder / "link.mcap").symlink_to(log)
    for target in ("log.mcap", "link.mcap", "./log.mcap"):
        done = shell("convert", "log.mcap", "-o", target, "--overwrite")
        assert done.code == 2
        assert "is the input itself" in done.err
    assert log.read_bytes() == WALK.read_bytes()


def test_targets_that_cannot_be_written(shell: Shell) -> None:
    (shell.folder / "file").write_text("")
    for target in ("no/such/x.mcap", "file/x.mcap", "x" * 300 + ".mcap"):
        done = shell("convert", TROUBLED, "-o", target)
        assert done.code in {1, 2}
        assert done.err.startswith("error: ")
        assert done.err.count("\n") == 1
    assert shell.files() == ["file"]


def test_a_long_name_that_the_disk_takes_is_taken(shell: Shell) -> None:
    name = "x" * 250 + ".mcap"
    (shell.folder / name).write_text("the disk takes it")
    assert shell("convert", TROUBLED, "-o", name, "--overwrite", "-q").code == 0
    assert shell.files() == [name]


def test_options_reach_the_conversion(shell: Shell) -> None:
    words = ["--start", "1", "--end", "2", "--tf-rate", "0", "--no-copy", "--compression", "none"]
    words += ["--no-scene", "--odom-topic", "/dogbot/odom", "--robot", "generic", "--mass", "10"]
    feet = ["--foot", "paw=/dogbot/back_left_contactsensor_state"]
    done = shell("convert", TROT, "-o", "x.mcap", "--json", *words, *feet)
    told = done.json
    assert told["messages"]["copied"] == 0
    assert told["robot"] == "generic"
    assert told["topics"]["feet"] == {"paw": "/dogbot/back_left_contactsensor_state"}
    # The first pose stands at the first time, too.
    assert told["annotations"]["/tf"] == 251
    assert set(told["annotations"]) == {
        "/tf",
        "/marker_basic_paw_foot",
        "/load/paw",
        "/label/paw",
        "/robot_description",
    }


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


def test_info_writes_graphs(shell: Shell) -> None:
    printed = shell("info", "--dot", TROUBLED, SHORT, "--jobs", 1)
    assert printed.code == 0
    assert printed.out.count("digraph ") == 2
    assert shell("info", "--dot", TROUBLED, SHORT, "-o", "frames.gv", "--jobs", 1).out == ""
    assert (shell.folder / "frames.gv").read_text(encoding="utf-8") == printed.out
    refused = shell("info", "--dot", SHORT, "-o", "frames.gv")
    assert refused.code == 2
    assert "--overwrite" in refused.err
    assert shell("info", "--dot", SHORT, "-o", "frames.gv", "--overwrite").code == 0
    assert shell("info", "--dot", "--json", SHORT).code == 2
    assert shell("info", SHORT, "-o", "other.gv").code == 2
    assert shell("info", "--dot", "none.bag", "-o", "other.gv").code == 2
    assert shell.files() == ["frames.gv"]


def test_stats_draws_a_figure(shell: Shell) -> None:
    done = shell("stats", WALK, "--plot", "walk.svg", "--window", "2:4", "--json")
    assert done.code == 0
    assert done.json["gait"]["class"] == "walk"
    assert "walk.svg: 2.00 to 4.00 s" in done.err
    first = (shell.folder / "walk.svg").read_bytes()
    refused = shell("stats", WALK, "--plot", "walk.svg")
    assert refused.code == 2
    assert "--overwrite" in refused.err
    again = shell(
        "stats", WALK, "--plot", "walk.svg", "--window", "2:4", "--overwrite", "--jobs", 3, "-q"
    )
    assert (again.code, again.err) == (0, "")
    assert (shell.folder / "walk.svg").read_bytes() == first


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ([TROT, WALK, "--plot", "both.pdf"], "call it for each"),
        ([WALK, "--plot", "walk.eps"], "must end in one of .pdf, .png, .svg"),
        ([WALK, "--plot", "none/walk.pdf"], "no such folder"),
        ([WALK, "--plot", "walk.pdf", "--plot-size", "85x"], "must be WIDTH or WIDTHxHEIGHT"),
        ([WALK, "--plot", "walk.pdf", "--plot-size", "nan"], "must be WIDTH or WIDTHxHEIGHT"),
        ([WALK, "--plot", "walk.pdf", "--plot-size", "85x20"], "at least"),
        ([WALK, "--plot", "walk.pdf", "--window", "100:200"], "has no time there"),
        ([WALK, "--plot", "walk.pdf", "--window", "0:inf"], "must be FROM:TO"),
        ([WALK, "--plot-size", "85"], "goes with --plot"),
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
    refused = run_afresh("stats", WALK, "--plot", "walk.pdf", folder=tmp_path)
    assert refused.code == 1
    assert install_command("plot") in refused.err
    assert run_afresh("stats", SHORT, "-q", folder=tmp_path).code == 0


def test_info_of_several_logs(shell: Shell) -> None:
    done = shell("info", SHORT, "nothing.bag", TROUBLED, "--json")
    assert done.code == 2
    assert [bool(one.get("error")) for one in done.json] == [False, True, False]
    assert done.err == "error: 1 of 3 logs could not be done\n  nothing.bag  no such file\n"


@pytest.mark.parametrize(
    ("words", "package"),
    [
        (("info", "s3://lab/walk.bag"), "upath"),
        (("info", "@s3://lab/list.txt"), "upath"),
        (("stats", TROT, "--scheduler", "tcp://x:1"), "distributed"),
        (("stats", TROT, "--parquet", "figures"), "pyarrow"),
    ],
)
def test_what_an_extra_brings_is_asked_for(
    shell: Shell, monkeypatch: pytest.MonkeyPatch, words: Sequence[object], package: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    dataset = ("cli.dataset", "report.dataset.dataset", "report.dataset.files")
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


# --- Hostile names --------------------------------------------------------------------------------

EVIL_TOPICS = (
    "/\x1b[31mred",
    "/bell\x07",
    "/back\x08space",
    "/two\nlines",
    "/\u202eleft",
    "/\x9b1m",
)


@pytest.mark.parametrize("topic", EVIL_TOPICS, ids=ascii)
def test_control_characters_in_topics_are_escaped(shell: Shell, topic: str) -> None:
    string_log(shell.folder / "log.mcap", [(topic, b"x")])
    told = [shell("info", "log.mcap"), shell("convert", "log.mcap")]
    odometry_log(shell.folder / "odom.mcap", topic, cut=1)
    told += [shell("info", "odom.mcap"), shell("convert", "odom.mcap", "-v")]
    for done in told:
        text = done.out + done.err
        assert topic not in text
        assert not [c for c in text if not c.isprintable() and c != "\n"]
    assert [done.code for done in told] == [0, 1, 0, 3]
    escaped = topic.encode("unicode_escape").decode()
    for done in told:
        assert escaped in "".join((done.out + done.err).split())


def test_a_newline_in_a_topic_starts_no_line(shell: Shell) -> None:
    string_log(shell.folder / "log.mcap", [("/said\nerror: send money", b"x")])
    done = shell("convert", "log.mcap")
    assert not [line for line in done.err.split("\n") if line.startswith("error: send money")]


def test_names_with_markup_and_odd_bytes(shell: Shell) -> None:
    name = os.fsdecode(b"[bold]\xff.mcap")
    odometry_log(shell.folder / name, "/[red]odom[/red]")
    done = run("info", name, folder=shell.folder)
    assert (done.code, done.err) == (0, "")
    assert "/[red]odom[/red]" in done.out
    assert "[bold]" in done.out
    done = run("convert", name, "--json", folder=shell.folder)
    assert done.code == 0
    assert done.json["annotations"] == {"/tf": 10, "/robot_description": 1}


# --- Processes ------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def long_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a log that takes a while: 120 MB of noise."""
    return odometry_log(tmp_path_factory.mktemp("long") / "long.mcap", "/odom", filler=12)


# A shell that runs the tests in the background has them, and their children, ignore Ctrl-C; nohup
# has them ignore that the terminal hangs up.
INTERRUPTIBLE = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
from dogbot_logtool.cli import cli, main
main()
"""


@pytest.mark.parametrize(
    ("number", "jobs", "twins"),
    [(signal.SIGINT, 2, 0), (signal.SIGTERM, 1, 0), (signal.SIGHUP, 2, 1)],
)
def test_a_signal_amid_writing_leaves_nothing(
    tmp_path: Path, long_log: Path, number: signal.Signals, jobs: int, twins: int
) -> None:
    words = ["convert", str(long_log), "-o", "x.mcap", "--compression", "lz4", "--jobs", str(jobs)]
    if twins:
        twin = long_log.with_name("twin.mcap")
        twin.unlink(missing_ok=True)
        os.link(long_log, twin)
        words[2:4] = [str(twin), "-o", "."]
    process = subprocess.Popen(  # noqa: S603
        [sys.executable, "-c", INTERRUPTIBLE, *words],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process:
        for found in _until_written(tmp_path, process):
            assert found.stat().st_size < long_log.stat().st_size
        process.send_signal(number)
        out, err = process.communicate()
    assert process.returncode == 128 + number
    assert out == ""
    assert "Traceback" not in err
    assert err.strip() == "interrupted: nothing was left behind"
    assert list(tmp_path.iterdir()) == []


def _until_written(folder: Path, process: "subprocess.Popen[str]") -> Iterator[Path]:
    """Wait until part of the output is there; then yield it."""
    while process.poll() is None:
        for part in unfinished(folder, process.pid):
            with contextlib.suppress(FileNotFoundError):
                if part.stat().st_size:
                    yield part
                    return
        time.sleep(0.001)
    raise AssertionError(process.communicate()[1])


@pytest.mark.skipif(not hasattr(os, "O_TMPFILE"), reason="there are no files without names")
def test_a_killed_conversion_leaves_nothing(tmp_path: Path, long_log: Path) -> None:
    folder = tmp_path / "here"
    folder.mkdir()
    words = ["convert", str(long_log), "-o", "out/", "--compression", "lz4", "--jobs", "2"]
    process = subprocess.Popen(  # noqa: S603
        [sys.executable, "-m", "dogbot_logtool", *words],
        cwd=folder,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    with process:
        list(_until_written(folder, process))
        process.kill()
    assert process.returncode == -signal.SIGKILL
    assert list(folder.iterdir()) == []


def test_a_full_disk_leaves_nothing(tmp_path: Path) -> None:
    """A limit on file size stands for a disk that is full: the write fails midway."""

    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

    done = subprocess.run(  # noqa: S603
        [sys.executable, "-B", "-m", "dogbot_logtool", "convert", str(TROT), "-o", "x.mcap"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        preexec_fn=limit,
    )
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.startswith("error: x.mcap: cannot be written: ")
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_the_command_is_the_module(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "dogbot_logtool", "--version"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert __version__ in done.stdout


def test_no_progress_bar_where_there_is_no_terminal(tmp_path: Path) -> None:
    done = run("convert", TROUBLED, "-o", "x.mcap", folder=tmp_path)
    assert done.code == 0
    assert "\x1b" not in done.err
    assert "\r" not in done.err


@pytest.mark.parametrize(
    "logs", [[SHORT], [SHORT, first_seconds(TROUBLED)]], ids=["one", "several"]
)
@pytest.mark.parametrize("command", ["convert", "stats", "info"])
def test_a_terminal_shows_in_the_end_what_a_pipe_gets(
    tmp_path: Path, command: str, logs: list[Path]
) -> None:
    output = {"convert": ["-o", "./", "--overwrite"], "info": ["--frames"]}.get(command, [])
    words = [command, *map(str, logs), *output]
    size = {"COLUMNS": "160", "LINES": "200", "TERM": "xterm"}
    done = forked_cli.run(*words, folder=tmp_path, environment=size, stderr=subprocess.STDOUT)
    code, shown = forked_cli.run_on_terminal(*words, folder=tmp_path, environment=size)
    assert (done.returncode, code) == (0, 0)

    screen = pyte.Screen(160, 200)
    pyte.Stream(screen).feed(shown.decode())
    assert b"\x1b[2K" in shown, "no progress was shown"
    assert [line.rstrip() for line in screen.display if line.strip()] == [
        line.rstrip() for line in done.stdout.splitlines() if line.strip()
    ]


@pytest.mark.parametrize("command", ["info", "convert", "layout"])
def test_a_fifo_is_refused_with_a_sentence(shell: Shell, command: str) -> None:
    os.mkfifo(shell.folder / "fifo")
    done = shell(command, "fifo")
    assert done.code == 2
    assert "not a regular file" in done.err
