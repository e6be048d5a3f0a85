from pathlib import Path

import pytest

from dogbot_logtool.comparison.tolerances import FieldRules, Rules, Tolerance, load_rules
from dogbot_logtool.errors import CallError

TOML = """
[default]
rtol = 1e-9

[metres]
atol = 1e-6
fields = ["*position*"]

[radians]
atol = 1e-4
rtol = 1
fields = ["*position.angle", "*orientation*"]
"""


def load(path: Path, text: str, atol: float | None = None, rtol: float | None = None) -> Rules:
    file = path / "tolerances.toml"
    file.write_text(text, encoding="utf-8")
    return load_rules(atol, rtol, file, (), ())


def test_the_first_quantity_that_fits_counts_and_the_default_takes_the_rest(tmp_path: Path) -> None:
    fields = FieldRules(load(tmp_path, TOML), "/topic")
    assert fields.tolerance("pose.position.x") == Tolerance(1e-6, 0.0)
    assert fields.tolerance("position.angle") == Tolerance(1e-6, 0.0)
    assert fields.tolerance("pose.orientation.x") == Tolerance(1e-4, 1.0)
    assert fields.tolerance("speed") == Tolerance(0.0, 1e-9)


def test_options_beat_the_default_of_the_file(tmp_path: Path) -> None:
    rules = load(tmp_path, TOML, atol=0.5, rtol=0.0)
    assert rules.default == Tolerance(0.5, 0.0)
    assert FieldRules(rules).tolerance("position.x") == Tolerance(1e-6, 0.0)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a = 1", "a must be a table: [a]"),
        ("[metres]\natol = 1", "metres.fields is missing"),
        ("[metres]\nfields = 'x'", "metres.fields must be a list of globs"),
        ("[metres]\nfields = [1]", "metres.fields must be a list of globs"),
        ("[metres]\nfields = ['x']\nato = 1", "metres.ato: not known"),
        ("[default]\nfields = ['x']", "default.fields: not known"),
        ("[metres]\nfields = ['x']\natol = -1", "metres.atol is -1"),
        ("[metres]\nfields = ['x']\natol = nan", "metres.atol is nan"),
        ("[metres]\nfields = ['x']\nrtol = 'a'", "metres.rtol is 'a'; it must be a number"),
        ("[metres]\nfields = ['x']\nrtol = true", "metres.rtol is True; it must be a number"),
        ("[metres", "not valid TOML"),
    ],
)
def test_a_bad_file_is_told_with_its_key(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(CallError) as error:
        load(tmp_path, text)
    assert sentence in str(error.value)
    assert "tolerances.toml" in str(error.value)


def test_a_missing_file_is_a_wrong_call(tmp_path: Path) -> None:
    with pytest.raises(CallError, match="no such file"):
        load_rules(None, None, tmp_path / "none.toml", (), ())


def test_topics_are_taken_by_globs() -> None:
    rules = Rules(topics=("/marker_*", "/tf"), ignore=("*_left_*",))
    assert rules.takes("/tf")
    assert rules.takes("/marker_basic_front_right_foot")
    assert not rules.takes("/marker_basic_front_left_foot")
    assert not rules.takes("/odom")
    assert Rules(ignore=("/tf:header",)).takes("/tf")
