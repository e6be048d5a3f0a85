"""`check` as a user calls it, on the sample logs."""

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from tests.forked_cli import Ended, run
from tests.oracles.small_logs import first_seconds
from tests.paths import SAMPLE_LOGS

TROT = first_seconds(SAMPLE_LOGS / "dogbot_trot.bag", 4.0)
WALK = SAMPLE_LOGS / "dogbot_walk.mcap"
TROUBLED = SAMPLE_LOGS / "dogbot_troubled.bag"


def check(folder: Path, limits: str, *words: object) -> Ended:
    (folder / "limits.toml").write_text(limits, encoding="utf-8")
    return run("check", "--limits", "limits.toml", *map(str, words), folder=folder)


def test_a_good_log_ends_with_0(tmp_path: Path) -> None:
    ended = check(tmp_path, '[[rule]]\nfigure = "gait.name"\nequals = "trot"', TROT)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout == f"GOOD     {TROT}: 1 GOOD\n"


def test_a_broken_rule_ends_with_1_and_says_value_rule_and_where_to_look(tmp_path: Path) -> None:
    limits = '[[rule]]\nfigure = "forces.vertical_impulse_over_weight"\nbetween = [0.9, 1.1]'
    ended = check(tmp_path, limits, TROUBLED)

    assert ended.returncode == 1
    assert "  FAIL     forces.vertical_impulse_over_weight is 0.7545; wanted: 0.9 to 1.1 (" in (
        ended.stdout
    )


def test_an_unknown_figure_ends_with_1_unless_its_rule_allows_it(tmp_path: Path) -> None:
    limits = '[[rule]]\nfigure = "gait.name"\nequals = "trot"\n'

    assert check(tmp_path, limits, TROUBLED).returncode == 1
    assert check(tmp_path, f'{limits}null = "pass"', TROUBLED).returncode == 0


def test_several_logs_as_json_and_junit(tmp_path: Path) -> None:
    limits = '[[rule]]\nfigure = "gait.name"\nequals = "trot"\nname = "it trots"'
    ended = check(tmp_path, limits, TROT, WALK, "--json", "--junit", "checked.xml", "--jobs", 1)

    assert ended.returncode == 1
    assert [(each["status"], each["rules"][0]["value"]) for each in json.loads(ended.stdout)] == [
        ("GOOD", "trot"),
        ("FAIL", "walk"),
    ]
    suites = ET.parse(tmp_path / "checked.xml").getroot()  # noqa: S314 - our own
    assert [(suite.get("tests"), suite.get("failures")) for suite in suites] == [
        ("1", "0"),
        ("1", "1"),
    ]
    assert suites[1][0].get("name") == "it trots"


def test_a_log_that_cannot_be_read_is_an_error_of_its_own(tmp_path: Path) -> None:
    (tmp_path / "odd.bag").write_bytes(b"nothing")
    limits = '[[rule]]\nfinding = "E_*"'
    ended = check(tmp_path, limits, TROT, "odd.bag", "--junit", "checked.xml", "--jobs", 1)

    assert ended.returncode == 1
    suites = ET.parse(tmp_path / "checked.xml").getroot()  # noqa: S314 - our own
    assert [suite.get("errors") for suite in suites] == ["0", "1"]


def test_suggested_limits_pass_the_run_and_fail_another(tmp_path: Path) -> None:
    suggested = run("check", "--suggest", str(TROT), folder=tmp_path)

    assert suggested.returncode == 0
    assert check(tmp_path, suggested.stdout, TROT).returncode == 0
    assert check(tmp_path, suggested.stdout, WALK).returncode == 1


def test_a_baseline_is_another_run(tmp_path: Path) -> None:
    stats = run("stats", "--json", str(TROT), folder=tmp_path)
    (tmp_path / "yesterday.json").write_text(stats.stdout, encoding="utf-8")
    limits = '[[rule]]\nfigure = "feet.*.duty_factor.median"\nbaseline = { by_percent = 5 }'

    assert check(tmp_path, limits, TROT, "--baseline", "yesterday.json").returncode == 0
    assert check(tmp_path, limits, WALK, "--baseline", "yesterday.json").returncode == 1
    missing = check(tmp_path, limits, TROT)
    assert (missing.returncode, "need --baseline" in missing.stderr) == (2, True)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "needs one of --limits FILE.toml and --suggest"),
        (["--limits", "a.toml", "--suggest"], "needs one of"),
        (["--suggest", "--json"], "goes with none of the other outputs"),
        (["--limits", "none.toml"], "no such file"),
        (["--limits", "bad.toml"], "bad.toml, line 1: rule 1"),
        (["--limits", "good.toml", "--baseline", str(TROT)], "stats LOG --json > FILE.json"),
    ],
)
def test_wrong_calls(tmp_path: Path, words: list[str], says: str) -> None:
    (tmp_path / "bad.toml").write_text("[[rule]]\n", encoding="utf-8")
    (tmp_path / "good.toml").write_text("[[rule]]\nevent = 'fall'\n", encoding="utf-8")
    ended = run("check", str(TROT), *words, folder=tmp_path)

    assert ended.returncode == 2
    assert says in ended.stderr
