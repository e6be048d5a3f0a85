"""Files of labelled events, and what is missed, invented or late against them."""

from pathlib import Path

import pytest

from dogbot_logtool.commands.compare_events import compare_events
from dogbot_logtool.comparison.walks.event_files import LabelledEvent, read_event_file
from dogbot_logtool.comparison.walks.labelled_events import match_labels
from dogbot_logtool.errors import CallError
from dogbot_logtool.pipeline.options import StatsOptions, TopicOptions
from tests.forked_cli import run
from tests.paths import SAMPLE_LOGS
from tests.truth import gaits
from tests.truth.log_file import write_log
from tests.truth.robots import biped
from tests.truth.walking import Walk

TROT = SAMPLE_LOGS / "dogbot_trot.bag"


def written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def test_eurobench_yaml_is_read(tmp_path: Path) -> None:
    text = "l_heel_strike: [1.5, 0.5]\nr_toe_off:\n  - 0.75\nr_heel_strike:\nother: [1]\n"
    assert read_event_file(written(tmp_path, "a.yaml", text)) == [
        (0.5, "touchdown", "left"),
        (0.75, "lift_off", "right"),
        (1.5, "touchdown", "left"),
    ]


def test_bids_and_our_csv_are_read(tmp_path: Path) -> None:
    bids = "onset\tduration\ttrial_type\tfoot\n0.5\t0\tslip\tfl\n0.25\tn/a\tfall\tn/a\n"
    ours = "onset_s,duration_s,type,foot,value,unit,code\n0.5,0,slip,fl,,,\n0.25,,fall,,,,\n"
    expected = [(0.25, "fall", ""), (0.5, "slip", "fl")]
    assert read_event_file(written(tmp_path, "a.tsv", bids)) == expected
    assert read_event_file(written(tmp_path, "a.csv", ours)) == expected


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.yaml", "[1, 2]", "no lists by name"),
        ("a.yaml", "l_toe_off: {a: [", "is not YAML"),
        ("a.yaml", "l_toe_off: 3", "l_toe_off is no list"),
        ("a.yaml", "l_toe_off: [x]", "'x' is no time in seconds"),
        ("a.yaml", "knee: [1]", "no events in it"),
        ("a.tsv", "a\tb\n", "columns onset and trial_type"),
        ("a.csv", "", "columns onset_s and type"),
        ("a.csv", "onset_s,type\nnan,slip\n", "line 2: 'nan' is no time"),
    ],
)
def test_other_files_are_refused_in_a_sentence(
    tmp_path: Path, name: str, text: str, words: str
) -> None:
    with pytest.raises(CallError, match=words):
        read_event_file(written(tmp_path, name, text))


def test_each_event_is_matched_once_with_its_nearest() -> None:
    labels = [LabelledEvent(time, "slip", "a") for time in (1.0, 2.0, 3.0, 4.0)]
    found = [LabelledEvent(time, "slip", "a") for time in (0.2, 1.02, 1.04, 2.5, 3.95, 4.01, 9.0)]
    (match,) = match_labels(labels, [*found, LabelledEvent(1.0, "fall", "")], 0.1)
    assert match.late_s == pytest.approx([0.02, 0.01])
    assert match.missed_s == (2.0, 3.0)
    # Before the first label and after the last, nobody looked.
    assert match.invented_s == (1.04, 2.5, 3.95)


def test_nothing_found_is_all_missed() -> None:
    (match,) = match_labels([LabelledEvent(1.0, "slip", "a")], [], 0.1)
    assert (match.late_s, match.missed_s, match.invented_s) == ((), (1.0,), ())


def test_labels_of_sides_find_the_log_s_feet(tmp_path: Path) -> None:
    walk = Walk(gait=gaits.BIPED_WALK, robot=biped(), period_s=1.1, seconds=8.0)
    log = write_log(walk.recorded(200.0), tmp_path / "log.mcap")
    names = ("heel_strike", walk.touchdowns), ("toe_off", walk.liftoffs)
    lines = [
        f"{side}_{label}: {[time for time in times(foot).tolist() if 0.1 < time < 7.9]}"
        for foot, side in enumerate("lr")
        for label, times in names
    ]
    labels = written(tmp_path, "labels.yaml", "\n".join(lines))
    topics = {name: walk.robot.topic(foot) for foot, name in enumerate(walk.robot.feet)}
    options = StatsOptions(TopicOptions(mass_kg=60.0, foot_topics=topics))
    matches = compare_events(labels, log, 0.006, options)
    assert {each.foot for each in matches} == {"left", "right"}
    assert sum(each.labelled for each in matches) > 25
    assert all(not each.missed_s and not each.invented_s for each in matches)


def test_the_events_of_a_log_are_those_that_stats_writes(tmp_path: Path) -> None:
    assert run("stats", "-q", TROT, "--events", "e.tsv", folder=tmp_path).returncode == 0
    same = run("compare", "e.tsv", TROT, folder=tmp_path)
    assert (same.returncode, same.stderr) == (0, "")
    assert same.stdout.startswith("all labelled events are found (within 50 ms)")
    lines = (tmp_path / "e.tsv").read_text().splitlines()
    (tmp_path / "more.tsv").write_text("\n".join([*lines, "3.0\t0\tslip\tfront_left"]))
    more = run("compare", "more.tsv", "e.tsv", "--json", folder=tmp_path)
    assert more.returncode == 1
    assert '"missed_s": [\n        3.0\n      ]' in more.stdout


def test_feet_that_the_log_does_not_have_are_a_wrong_call(tmp_path: Path) -> None:
    labels = written(tmp_path, "a.yaml", "l_heel_strike: [1.0]")
    ended = run("compare", labels, TROT, folder=tmp_path)
    assert ended.returncode == 2
    assert "left is a side that the log does not have; it has front_left" in ended.stderr
