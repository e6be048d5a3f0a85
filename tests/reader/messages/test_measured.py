"""The synthetic walk in every type of contact message: what is measured and said of it."""

from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import get_types_from_msg

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.info import describe
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.errors import CallError
from dogbot_logtool.option import part_of
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.options.info import InfoOptions
from dogbot_logtool.report.documents import stats_json
from tests.oracles import state_walks, walks
from tests.oracles.state_walks import StateWalk

RAW = tuple(kind for kind in walks.KINDS if kind.startswith("unitree"))
XPP = state_walks.KINDS[0]
FORCE_FIGURES = (
    "peak_force_n",
    "peak_force_bw",
    "mean_force_n",
    "peak_vertical_force_n",
    "mean_vertical_force_n",
    "vertical_impulse_ns",
    "loading_rate_nps",
)


def figures(path: Path, options: MeasureOptions) -> dict[str, Any]:
    return stats_json(measure(path, options))


def said(found: dict[str, Any]) -> dict[str, str]:
    texts: dict[str, str] = {}
    for each in found["findings"]:
        texts[each["code"]] = f"{texts.get(each['code'], '')} {each['text']}"
    return texts


def check_touchdowns(found: dict[str, Any], shift_s: float = 0.0) -> None:
    """Check that feet step when the walk does; `shift_s` later."""
    for leg in walks.LEGS:
        changes = np.flatnonzero(np.diff(walks.TOUCHES[leg].astype(int), prepend=0))
        expected = [float(sample) * walks.STEP / 1e9 + shift_s for sample in changes[0::2]]
        assert found["feet"][leg]["touchdown_s"] == pytest.approx(expected, abs=1e-6)


def check_no_forces(found: dict[str, Any]) -> None:
    for leg in walks.LEGS:
        assert [found["feet"][leg][name] for name in FORCE_FIGURES] == [None] * len(FORCE_FIGURES)
    assert found["forces"]["load_share"] is None or not any(found["forces"]["load_share"].values())
    assert found["forces"]["vertical_impulse_over_weight"] is None


# Raw counts


@pytest.mark.parametrize("name", ["unitree_go2", "generic"])
def test_raw_counts_are_not_passed_off_as_newtons(tmp_path: Path, name: str) -> None:
    """But two clear modes of each foot's counts tell when it touches."""
    path = walks.write_walk(tmp_path, "unitree_go/msg/LowState", "mcap")
    feet = dict.fromkeys(walks.LEGS, "/feet") if name == "unitree_go2" else None
    options = MeasureOptions(robot=name, foot=feet)
    told = describe(path, part_of(options, InfoOptions))
    assert "NO_FORCE" in {each.code for each in told.findings}
    found = figures(path, options)
    assert "no forces; contact from" in said(found)["NO_FORCE"]
    assert "both estimated from the log" in said(found)["NO_FORCE"]
    check_no_forces(found)
    check_touchdowns(found)


def test_counts_of_a_robot_that_stands_tell_nothing(tmp_path: Path) -> None:
    kind, walk = "unitree_go/msg/LowState", walks.Walk(2)
    counts = np.random.default_rng(1).normal(120.0, 4.0, (400, 4))
    entries = []
    for sample, values in enumerate(counts):
        message = walk.make(kind, foot_force=values, tick=sample)
        time = walks.START + sample * walks.STEP
        entries.append(walks.Entry("/feet", kind, time, walk.bytes_of(kind, message)))
    found = figures(walks.write_log(tmp_path, walk, entries), MeasureOptions(robot="generic"))
    for foot in found["feet"].values():
        assert (foot["contact_fraction"], foot["touchdown_s"]) == (None, None)
    assert "without contact.on_counts no contact either" in said(found)["NO_FORCE"]


@pytest.mark.parametrize("kind", RAW)
def test_counts_without_a_scale_give_a_gait_and_no_forces(tmp_path: Path, kind: str) -> None:
    path = walks.write_walk(tmp_path, kind, "mcap")
    robot = walks.robot_file(tmp_path, kind)
    lines = robot.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not line.startswith("newtons_per_count")]
    robot.write_text("\n".join(["contact.on_counts = 30", *kept]), encoding="utf-8")
    options = MeasureOptions(robot=str(robot))
    found = figures(path, options)
    assert found["gait"]["name"] == "trot"
    check_no_forces(found)
    check_touchdowns(found)
    assert "contact from 30 counts above a foot's offset on" in said(found)["NO_FORCE"]
    assert "WRENCH_FRAME" not in said(found)

    done = convert(path, tmp_path / "out.mcap", part_of(options, ConvertOptions))
    assert "NOT_FINITE" not in {finding.code for finding in done.findings}
    assert not any(n for topic, n in done.annotations.items() if "marker" in topic)


class Rounded(StateWalk):
    """Counts that are as good as constant on the ground, and jitter by one in the air.

    Those of one sensor are 30 times as many.
    """

    ticks = count()

    def counts(self, forces: Any) -> Any:
        down = {leg: force[2] > 0.0 for leg, force in forces.items()}
        order = ("front_right", "front_left", "back_right", "back_left")
        jitter = int(next(self.ticks) % 2)
        loaded = dict.fromkeys(order, 140) | {"back_left": 4200}
        return np.array([loaded[leg] if down[leg] else 20 + jitter for leg in order], np.int16)


def test_counts_of_two_levels_tell_contact(tmp_path: Path) -> None:
    """The narrower level is that of stance here, but a load never lowers a count."""
    walk = Rounded(2)
    path = walks.write_log(tmp_path, walk, walk.messages("go2_interfaces/msg/Go2State"))
    check_touchdowns(figures(path, MeasureOptions()))


# Flags beside forces


class Unflagged(StateWalk):
    """A publisher that never sets its flags."""

    def flags(self, sample: int, legs: Any = walks.LEGS) -> Any:
        return np.zeros_like(super().flags(sample, legs))


class Inverted(StateWalk):
    """A publisher that turns one of its flags round."""

    def flags(self, sample: int, legs: Any = walks.LEGS) -> Any:
        return super().flags(sample, legs) ^ np.array([False, False, False, True])


class Shifted(StateWalk):
    """A plan whose flags end contact before the force does."""

    def flags(self, sample: int, legs: Any = walks.LEGS) -> Any:
        return super().flags(min(sample + 4, walks.SAMPLES - 1), legs)


@pytest.mark.parametrize(
    ("maker", "shift_s"), [(Unflagged, 0.0), (Inverted, 0.0), (Shifted, -0.04)]
)
def test_flags_decide_unless_they_are_never_set_or_inverted(
    tmp_path: Path, maker: type[StateWalk], shift_s: float
) -> None:
    walk = maker(2)
    path = walks.write_log(tmp_path, walk, walk.messages(XPP))
    found = figures(path, MeasureOptions(mass=walks.MASS_KG))
    assert "FLAGS_CONTRADICTED" in said(found)
    check_touchdowns(found, shift_s)


# Which feet, and which topic


def test_two_feet_are_not_one_element(tmp_path: Path) -> None:
    path = walks.write_walk(tmp_path, "spot_msgs/msg/FootStateArray", "mcap")
    options = InfoOptions(robot="generic", foot={"fl": "/feet", "front_left": "/feet"})
    with pytest.raises(CallError, match="would be that of fl, front_left"):
        describe(path, options)


def test_a_foot_that_no_message_names_is_not_sure(tmp_path: Path) -> None:
    path = walks.write_walk(tmp_path, "spot_msgs/msg/FootStateArray", "mcap")
    found = describe(path, InfoOptions(robot="generic", foot={"nose": "/feet"})).findings
    assert "which element of /feet is nose is not known" in " ".join(each.text for each in found)


@pytest.mark.parametrize(
    ("kind", "fields"),
    [
        # A robot without legs that uses the same controller.
        ("ocs2_msgs/msg/mpc_observation", {"state": [np.zeros(10)], "input": [np.zeros(3)]}),
        # Unitree's humanoids have a LowState without forces on feet.
        ("unitree_hg/msg/LowState", {"position": np.zeros(3)}),
    ],
)
def test_types_that_do_not_tell_of_feet(tmp_path: Path, kind: str, fields: dict[str, Any]) -> None:
    walk = walks.Walk(2)
    if kind not in walk.store.fielddefs:
        walk.store.register(get_types_from_msg("uint32 tick\nfloat32[3] position", kind))
    data = walk.bytes_of(kind, walk.make(kind, **fields))
    base = [each for each in walks.messages(2, RAW[0]) if each.topic == "/odom"]
    feet = [each._replace(topic="/feet", kind=kind, data=data) for each in base]
    found = describe(walks.write_log(tmp_path, walk, [*base, *feet]), InfoOptions())
    assert {topic.topic: topic.use for topic in found.topics}["/feet"] == ""
    assert "NO_FEET" in {finding.code for finding in found.findings}
