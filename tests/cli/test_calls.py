"""Calls as users type them: exit code, the first line of stderr, and what stdout says."""

import shlex

import click
import pytest

from dogbot_logtool import __version__
from dogbot_logtool.cli import cli
from dogbot_logtool.core.definitions import definitions
from dogbot_logtool.option import _EVERYWHERE, options_of
from dogbot_logtool.options import COMMANDS, CommonOptions, record_of
from tests.oracles.recorded import TEXT_TYPE, S
from tests.oracles.small_logs import first_seconds, text, write_ros1_mcap
from tests.oracles.walks import Entry
from tests.paths import TROT, TROUBLED, WALK
from tests.shell import Shell

COMMON = {"jobs", "scheduler", *(each.name for each in options_of(CommonOptions))}

WRONG = """
nonsense | No such command 'nonsense'
convert | Missing argument 'LOG...'
info --nonsense TROT | No such option '--nonsense'
convert TROT --style loud | 'loud' is not one of 'pressure', 'force', 'classic'
convert TROT --jobs 0 | --jobs 0: must be a whole number from 1 to 256
convert TROT --jobs x | --jobs x: must be a whole number
convert TROT --tf-rate nan | --tf-rate nan: must be a number from 0.001 to 1e+06, or 0
convert TROT --end inf | --end inf: must be a number of seconds
convert TROT --foot front_left | --foot front_left: must be NAME=TOPIC[:FIELD]
convert TROT --foot 'front left=/x' | a foot's name has letters, digits and _ only
convert TROT --foot a=/x --foot a=/y | --foot a: is given twice
convert TROT --foot front_left=/dogbot/odom | is of type nav_msgs/Odometry
convert TROT --foot back_left=/dogbot/back_left | did you mean /dogbot/
convert TROT --foot nose=CONTACTS | has no such foot; it has front_left
convert TROT --robot dogbot --foot nose=CONTACTS | has no such foot
convert TROT --robot generic --foot a=CONTACTS --foot b=CONTACTS | would be that of a, b, and is
convert TROT --foot front_left=CONTACTS | would be that of front_left, front_right
convert TROT --odom-topic dogbot/odom | did you mean /dogbot/odom?
convert TROT --odom-topic CONTACTS | is of type gazebo_msgs/ContactsState
convert TROT --robot unicorn | no robot is called 'unicorn'
convert TROT --robot unicorn.toml | unicorn.toml: no such file
convert TROT --no-copy --topics /x | --no-copy copies nothing
convert TROT TROUBLED -o x.mcap | x.mcap: is a file's name, and there are 2 logs
convert TROT -o none/x.mcap | none: no such folder
convert a/x.bag b/x.bag -o out | out/x.annotated.mcap: 2 logs of one name would go there
convert no_such.bag | no_such.bag: no such file
convert . | is a directory, not a log file, and holds no logs
stats 'runs/*.bag' | runs/*.bag: no file has such a name
stats '' | an empty name names no log
stats @absent.txt | absent.txt: no such file
stats TROT --start 5 --end 2 | --start 5 --end 2: the log has no messages there; it lasts from 0 to
convert TROT --start 2 --end 2 | --start 2 --end 2: the log has no messages there
report TROT --start 100 | --start 100: the log has no messages there
stats TROT --start -1 | --start -1: the log has no messages there
convert TROT --start -2 --end -1 | --start -2 --end -1: the log has no messages there
report TROT --end -1 | --end -1: the log has no messages there
stats TROT --end 0 | --end 0: the log has no messages there
convert TROUBLED --start 1.000000001 --end 1.000000002 | the log has no messages there
stats TROT --set contact_on=20 | did you mean contact_on_n
stats TROT --set contact_on_n | --set contact_on_n: must be FIELD=VALUE
stats TROT --set command_topic=/none | command_topic: the log has no topic /none
stats TROT --overwrite | --overwrite goes with --figure
stats TROT TROUBLED --figure x.pdf | call it for each
stats TROT --figure x.eps | must end in one of .pdf, .png, .svg
stats TROT --figure x.svg/ | is a directory's name
stats TROT --scheduler nonsense | must be an address such as tcp://host:8786
report TROT --against WALK --join | --join and --against: choose one
check TROT | check needs one of --limits FILE.toml and --suggest
check TROT --suggest --json | goes with none of the other outputs
export TROT -o x.xlsx | x.xlsx: must end in .csv, .parquet, .arrow, .feather
export TROT --overwrite | --overwrite goes with -o FILE
export TROT --prune | --prune goes with --dataset
export TROT --dataset walks --table base | --table goes without --dataset
export TROT --dataset walks --label firmware | must be NAME=VALUE
export TROT --dataset walks --label a=1 --label a=2 | a is there twice
compare TROT | Missing argument 'ACTUAL'
compare TROT . | .: is a directory, not a log file, and holds no ROS 2 bag
compare TROT WALK --mass 20 | --mass says how logs are measured: it goes with --gait
compare TROT WALK --junit TROUBLED | exists already; --overwrite replaces it
compare TROT WALK --junit WALK --overwrite | is the input itself
compare TROT WALK --gait --atol 1 | --atol has no meaning with --gait
layout --viewer rerun | 'rerun' is not one of 'foxglove', 'rviz'
layout -o x/ | is a directory's name
robots unicorn | no robot is called 'unicorn'; known are
robots new | robots new: name the log
robots new a.bag b.bag | with --join, several files of one recording
info -o tree.gv TROT | -o is gone: results go to stdout
convert TROT -o - | -: does not stand for stdout here
layout -o '' | an empty name names no output
"""
NAMES = {
    "TROT": str(TROT),
    "TROUBLED": str(TROUBLED),
    "WALK": str(WALK),
    "CONTACTS": "/dogbot/front_right_contactsensor_state",
}


def words_of(call: str) -> list[str]:
    """Return the words of a call, in which names may stand for others, also behind a foot's."""
    words = (word.rpartition("=") for word in shlex.split(call))
    return [f"{foot}{sign}{NAMES.get(name, name)}" for foot, sign, name in words]


@pytest.mark.parametrize("line", WRONG.strip().splitlines(), ids=lambda line: line.split("|")[0])
def test_wrong_calls_exit_with_2_and_a_sentence(shell: Shell, line: str) -> None:
    call, _, sentence = line.partition("|")
    done = shell(*words_of(call))
    assert (done.code, done.out, shell.files()) == (2, "", [])
    assert sentence.strip() in " ".join(done.err.split())


RIGHT = """
--version | version VERSION
-h | Exit codes: 0 done
info SHORT | odometry
info SHORT --json | "container": "ROS 1 bag"
info --frames SHORT | added by convert
stats SHORT | Gait: trot
stats SHORT --start 0 | Gait: trot
stats SHORT --start 0.5 --end 1e9 | Gait: trot
stats SHORT -v | no header stamps
stats TROT WALK | dogbot_walk.mcap walk high
check SHORT --suggest | [[rule]]
export SHORT | log,foot,start_s
layout | "configById"
layout SHORT --viewer rviz | Visualization Manager
robots | dogbot
robots dogbot | [feet.front_left]
robots new SHORT | [feet.front_left]
"""


@pytest.mark.parametrize("line", RIGHT.strip().splitlines(), ids=lambda line: line.split("|")[0])
def test_right_calls_print_on_stdout(shell: Shell, line: str) -> None:
    call, _, sentence = line.partition("|")
    short = str(first_seconds(TROT, 5.0))
    done = shell(*(short if word == "SHORT" else word for word in words_of(call)))
    assert (done.code, shell.files()) == (0, [])
    printed = done.out + " ".join(done.out.split())
    assert sentence.strip().replace("VERSION", __version__) in printed
    assert "error" not in done.err


def test_help_fits_a_terminal(shell: Shell, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    for words in ([], *([each] for each in COMMANDS)):
        done = shell(*words, "-h")
        assert (done.code, done.err) == (0, "")
        assert max(map(len, done.out.splitlines())) <= 80
        assert "Example" in done.out or not words
    listed = shell("-h").out.partition("Commands:\n")[2].splitlines()
    assert len(listed) == len(COMMANDS)
    assert not any("..." in line for line in listed)


def test_every_option_says_what_it_does_and_there_are_few() -> None:
    for record in map(record_of, COMMANDS):
        options = options_of(record)
        own = [each for each in options if each.name not in COMMON and not each.how.is_argument]
        assert all(definitions(record).get(each.name) for each in own)
        assert len(own) <= 18, record


def test_shells_complete_choices_and_files() -> None:
    convert = cli.get_command(click.Context(cli), "convert")
    assert convert is not None
    types = {each.name: each.type for each in convert.params}
    assert isinstance(types["style"], click.Choice)
    assert isinstance(types["logs"], click.Path)


def test_options_that_are_gone_say_what_to_use(shell: Shell) -> None:
    for option, instead in _EVERYWHERE.items():
        command = {"--update": "compare", "--dot": "info"}.get(option, "convert")
        done = shell(command, TROT, option)
        assert (done.code, done.out, shell.files()) == (2, "", [])
        assert f"{option} is gone: {instead}." in done.err
    assert "export --table events" in shell("stats", TROT, "--events", "x.csv").err


@pytest.mark.parametrize("command", ["info", "convert", "report"])
def test_what_is_no_log_exits_with_1(shell: Shell, command: str) -> None:
    (shell.folder / "text.bag").write_text("a walk in the park")
    (shell.folder / "empty.bag").write_bytes(b"")
    for name in ("text.bag", "empty.bag"):
        done = shell(command, name)
        assert (done.code, done.out, done.err.count("\n")) == (1, "", 1)
        assert done.err.startswith(f"error: {name}: ")
    assert shell.files() == ["empty.bag", "text.bag"]


def test_nothing_to_annotate_lists_the_topics(shell: Shell) -> None:
    write_ros1_mcap(shell.folder / "log.mcap", [Entry("/said", TEXT_TYPE, S, text("hello"))])
    done = shell("convert", "log.mcap")
    assert (done.code, done.out, shell.files()) == (1, "", ["log.mcap"])
    assert "/said  std_msgs/String" in done.err


def test_a_bad_log_does_not_stop_the_others(shell: Shell) -> None:
    short = first_seconds(TROT)
    done = shell("info", short, "nothing.bag", TROUBLED, "--json", "--jobs", 1)
    assert done.code == 2
    assert [bool(one.get("error")) for one in done.json] == [False, True, False]
    assert done.err == "error: 1 of 3 logs could not be done\n  nothing.bag  no such file\n"


@pytest.mark.parametrize("command", ["convert", "stats", "report"])
def test_each_log_has_its_own_span(shell: Shell, command: str) -> None:
    done = shell(command, TROT, first_seconds(TROUBLED), "--start", "5.5", "--end", "6.5")
    assert done.code == 2
    assert "1 of 2 logs could not be done" in done.err
    assert "it lasts from 0 to 2.000 s" in " ".join(done.err.split())
    assert len(shell.files()) == {"convert": 1, "stats": 0, "report": 3}[command]
