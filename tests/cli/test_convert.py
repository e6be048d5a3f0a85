"""`convert` on the command line: what it says, where it writes, and how it exits."""

from mcap.reader import make_reader

from dogbot_logtool import __version__
from tests.oracles.small_logs import odometry_log
from tests.paths import TROT, TROUBLED, WALK
from tests.shell import Outcome, Shell

MAGIC = b"\x89MCAP0\r\n"


def test_convert_says_what_it_did_on_stderr_only(shell: Shell) -> None:
    done = shell("convert", TROUBLED)
    assert (done.code, done.out) == (0, "")
    assert shell.files() == ["dogbot_troubled.annotated.mcap"]
    assert "dogbot_troubled.annotated.mcap: 3,659 recorded messages and 4,738 ann" in done.err
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
    assert {finding["code"] for finding in told["findings"]} >= {"BAD_STAMPS"}
    assert told["damage"] == {"text": None, "messages": 0, "bytes": 0, "places": []}


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


def test_damage_exits_with_3(shell: Shell) -> None:
    log = odometry_log(shell.folder / "log.mcap", "/odom", cut=1)
    done = shell("convert", log, "-o", "x.mcap", "--json")
    assert done.code == 3
    assert done.json["damage"]["messages"] == 1
    assert "damage" in done.err
    assert "/odom" in done.err
    assert shell.files() == ["log.mcap", "x.mcap"]


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
    words += ["--odom-topic", "/dogbot/odom", "--robot", "generic", "--mass", "10"]
    feet = ["--foot", "paw=/dogbot/back_left_contactsensor_state"]
    done = shell("convert", TROT, "-o", "x.mcap", "--json", *words, *feet)
    told = done.json
    assert told["messages"]["copied"] == 0
    assert told["robot"] == "generic"
    assert told["topics"]["feet"] == {
        "paw": "/dogbot/back_left_contactsensor_state",
        **dict.fromkeys(("front_left", "front_right", "back_right"), ""),
    }
    # The first pose stands at the first time, too.
    assert told["annotations"]["/tf"] == 251
    assert {topic for topic, count in told["annotations"].items() if count > 1} == {
        "/tf",
        "/marker_basic_paw_foot",
        "/load/paw",
        "/label/paw",
        "/support",
    }
    assert told["annotations"]["/robot_description"] == 1
