"""Which feet names tell of: real sets of topics, and what must not change the answer."""

from collections.abc import Mapping, Sequence
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dogbot_logtool.robot.names import FootSet, leg_position, name_feet
from dogbot_logtool.robot.words import words_of

CORNERS = {
    "front_left": ("lf", "fl", "left_front", "front_left"),
    "front_right": ("rf", "fr", "right_front", "front_right"),
    "back_left": ("lh", "rl", "left_hind", "rear_left"),
    "back_right": ("rh", "rr", "right_hind", "rear_right"),
}
SIDES = ("left", "right")


def legs(pattern: str, style: int = 0) -> dict[str, str]:
    """Topics of four feet; their legs are named LF, FL, left_front or front_left, by style."""
    return {leg: pattern.format(names[style]) for leg, names in CORNERS.items()}


def capital(pattern: str, style: int = 0) -> dict[str, str]:
    return {leg: pattern.format(names[style].upper()) for leg, names in CORNERS.items()}


def two(pattern: str, left: str = "left", right: str = "right") -> dict[str, str]:
    return {"left": pattern.format(left), "right": pattern.format(right)}


def numbered(pattern: str, numbers: Sequence[int], name: str = "leg") -> dict[str, str]:
    return {f"{name}_{number}": pattern.format(number) for number in numbers}


def six(pattern: str, ends: Sequence[str] = ("front", "middle", "hind")) -> dict[str, str]:
    return {
        f"{end}_{side}": pattern.format(side=side, end=word)
        for end, word in zip(("front", "middle", "back"), ends, strict=True)
        for side in SIDES
    }


def rows(pattern: str, numbers: Sequence[object] = (1, 2, 3)) -> dict[str, str]:
    """Topics of two rows of legs; the pattern is given l or r, the side and the number."""
    return {
        f"{side}_{number}": pattern.format(side[0], side, number)
        for number in numbers
        for side in SIDES
    }


def topics(*sets: Mapping[str, str]) -> list[str]:
    return [topic for one in sets for topic in one.values()]


def told(feet: FootSet | None) -> dict[str, str]:
    return {foot.name: foot.topic for foot in feet.feet} if feet else {}


WRENCHES, CONTACTS = False, True
"""Whether messages of the type tell of contacts and of nothing else."""
CLEAR: dict[str, tuple[bool, dict[str, str], list[str]]] = {
    "reem-c": (WRENCHES, two("/{}_foot/wrench"), []),
    "talos": (WRENCHES, two("/{}_ankle_ft"), topics(two("/{}_wrist_ft"))),
    "thormang3": (
        WRENCHES,
        two("/robotis/sensor/ft_{}_foot/scaled"),
        topics(two("/robotis/sensor/ft_{}_foot/raw")),
    ),
    "thormang3 raw": (WRENCHES, two("/robotis/sensor/ft_{}_foot/raw"), []),
    "hrpsys": (WRENCHES, two("/{}fsensor", "l", "r"), topics(two("/{}hsensor", "l", "r"))),
    "hrpsys offset": (
        WRENCHES,
        two("/off_{}fsensor", "l", "r"),
        topics(
            two("/{}fsensor", "l", "r"),
            two("/ref_{}fsensor", "l", "r"),
            two("/{}asensor", "l", "r"),
            two("/off_{}hsensor", "l", "r"),
        ),
    ),
    "valkyrie": (WRENCHES, two("/sensors/{}FootSixAxis"), []),
    "camel case": (WRENCHES, two("/{}FootFTSensor", "Left", "Right"), []),
    "toe to toe": (WRENCHES, two("/{}-toe_contact"), []),
    "named feet": (WRENCHES, two("/ft_sensor/{}_foot"), topics(two("/ft_sensor/{}_hand"))),
    "side last": (WRENCHES, two("/foot_wrench_{}"), []),
    "a letter": (WRENCHES, two("/{}_sole/ft", "l", "r"), []),
    "glued letter": (WRENCHES, two("/{}leg/ft", "l", "r"), topics(two("/{}arm/ft", "l", "r"))),
    "dots": (WRENCHES, two("robot.{}.foot.force"), []),
    "leg twice": (WRENCHES, two("/{0}_leg/{0}_foot/wrench"), []),
    "feet above": (WRENCHES, two("/feet/{}"), []),
    "bare sides": (CONTACTS, two("/{}/contact"), []),
    "measured": (
        WRENCHES,
        two("/{}_foot/measured/wrench"),
        topics(two("/{}_foot/desired/wrench")),
    ),
    "anymal": (WRENCHES, legs("/state_estimator/contact_force_{}_foot"), []),
    "LF_FOOT": (CONTACTS, capital("/contacts/{}_FOOT"), []),
    "unitree visual": (WRENCHES, capital("/visual/{}_foot_contact/the_force", 1), []),
    "FL_foot": (CONTACTS, capital("/{}_foot", 1), topics(capital("/{}_calf", 1))),
    "FLfoot": (CONTACTS, capital("/{}foot", 1), []),
    "FL/FL_foot": (CONTACTS, capital("/{0}/{0}_foot_contact", 1), []),
    "fl": (CONTACTS, legs("/{}", 1), []),
    "bare corners": (WRENCHES, legs("/{}/wrench", 1), []),
    "legs of controller rl": (CONTACTS, legs("/rl_controller/{}/contact", 3), []),
    "letters of controller rl": (CONTACTS, legs("/rl_controller/{}/contact", 1), []),
    "feedback": (WRENCHES, two("/feedback/{}_foot"), []),
    "backend": (CONTACTS, legs("/backend/left/{}_foot", 3), []),
    "controller of a leg": (CONTACTS, legs("/left_leg_controller/{}/contact", 3), []),
    "hind": (CONTACTS, legs("/legs/{}_contact", 2), []),
    "side above": (
        CONTACTS,
        {
            f"{end}_{side}": f"/{side}/{word}_foot"
            for end, word in (("front", "fore"), ("back", "hind"))
            for side in SIDES
        },
        [],
    ),
    "glued corners": (
        CONTACTS,
        {leg: f"/{leg.replace('_', '')}_bumper" for leg in CORNERS},
        topics(two("/{}_bumper")),
    ),
    "camel corners": (
        CONTACTS,
        {
            f"{end}_{side}": f"/{end}{side.title()}Foot"
            for end in ("front", "back")
            for side in SIDES
        },
        [],
    ),
    "hexapod": (CONTACTS, six("/hexapod/{side}_{end}_foot"), []),
    "hexapod end first": (CONTACTS, six("/{end}_{side}/contact", ("front", "middle", "back")), []),
    "hexapod letters": (
        CONTACTS,
        {
            f"{end}_{side}": f"/{side[0]}{letter}_tip"
            for end, letter in (("front", "f"), ("middle", "m"), ("back", "r"))
            for side in SIDES
        },
        [],
    ),
    "numbered legs": (WRENCHES, numbered("/leg_{}/force", range(1, 7)), []),
    "legs from 0": (CONTACTS, numbered("/leg{}/contact", range(4)), []),
    "numbered feet": (CONTACTS, numbered("/robot_1/foot_{}", range(1, 9), "foot"), []),
    "a number alone": (CONTACTS, numbered("/leg/{}/force", range(1, 7)), []),
    "rows of legs": (WRENCHES, rows("/crab/{0}{2}/foot_force"), []),
    "rows of legs in words": (WRENCHES, rows("/{1}_leg_{2}/force"), []),
    "rows of legs glued": (CONTACTS, rows("/hexapod/leg_{0}{2}/contact"), []),
    "rows, number first": (CONTACTS, rows("/leg{2}_{1}"), []),
    "anterior and posterior": (
        WRENCHES,
        {
            f"{end}_{side}": f"/{word}_{side}/grf"
            for end, word in (("front", "anterior"), ("back", "posterior"))
            for side in SIDES
        },
        [],
    ),
    "three of four": (
        CONTACTS,
        {leg: f"/{leg}_foot" for leg in ("front_left", "front_right", "back_left")},
        ["/trunk_contact"],
    ),
}
UNSURE: dict[str, tuple[bool, list[str], dict[str, str]]] = {
    "lone foot": (WRENCHES, ["/left_foot/wrench"], {"left": "/left_foot/wrench"}),
    "planned only": (WRENCHES, topics(two("/ref_{}_foot")), two("/ref_{}_foot")),
    "bare sides": (WRENCHES, topics(two("/{}/wrench")), two("/{}/wrench")),
    "toe and heel": (CONTACTS, topics(two("/{}_toe"), two("/{}_heel")), two("/{}_heel")),
    "front and back of feet": (
        CONTACTS,
        topics(two("/{}_foot_front"), two("/{}_foot_back")),
        two("/{}_foot_back"),
    ),
    "front and back below feet": (
        WRENCHES,
        topics(two("/{}_foot/front/ft"), two("/{}_foot/rear/ft")),
        two("/{}_foot/front/ft"),
    ),
    "two numbers a foot": (
        CONTACTS,
        topics(two("/{}_foot_1"), two("/{}_foot_2")),
        two("/{}_foot_1"),
    ),
    "four corners of two feet": (
        WRENCHES,
        topics(legs("/left_foot/{}", 1), legs("/right_foot/{}", 1)),
        two("/{}_foot/fl"),
    ),
    "rows of feet": (CONTACTS, topics(rows("/foot_{0}{2}")), rows("/foot_{0}{2}")),
    "lettered rows": (
        WRENCHES,
        topics(rows("/{2}{0}_tip/wrench", "abc")),
        rows("/{2}{0}_tip/wrench", "abc"),
    ),
    "legs of two robots": (
        WRENCHES,
        topics(two("/robot1_{}_leg"), two("/robot2_{}_leg")),
        two("/robot1_{}_leg"),
    ),
    "offset of what": (
        WRENCHES,
        topics(two("/{}FootSixAxis"), two("/{}FootSixAxis_Offset")),
        two("/{}FootSixAxis"),
    ),
    "two robots": (
        CONTACTS,
        topics(legs("/spot1/{}_foot", 1), legs("/spot2/{}_foot", 1)),
        legs("/spot1/{}_foot", 1),
    ),
    "calves": (
        CONTACTS,
        topics(capital("/{}_calf_contact", 1)),
        capital("/{}_calf_contact", 1),
    ),
    "two feet of four": (
        CONTACTS,
        ["/lf_contact", "/rf_contact"],
        {"front_left": "/lf_contact", "front_right": "/rf_contact"},
    ),
    "two numbers": (CONTACTS, ["/foot_1", "/foot_2"], numbered("/foot_{}", (1, 2), "foot")),
    "a bumper": (CONTACTS, ["/bumper 7"], {"bumper_7": "/bumper 7"}),
    "feet of nobody": (
        CONTACTS,
        ["/a/left_front", "/b/left_front"],
        {"a_left_front": "/a/left_front", "b_left_front": "/b/left_front"},
    ),
}
NO_FEET: dict[str, tuple[bool, list[str]]] = {
    "nothing": (CONTACTS, []),
    "drill": (WRENCHES, ["/rl_tool/drill/force"]),
    "a sensor": (WRENCHES, ["/ft_sensor"]),
    "arms": (WRENCHES, topics(two("/{}_arm/wrench"))),
    "hands": (CONTACTS, topics(two("/hands/{}/contact"))),
    "hands of hrpsys": (WRENCHES, topics(two("/{}hsensor", "l", "r"))),
    "grippers": (CONTACTS, topics(two("/robot_gripper/{}_contact_finger"))),
    "fingers": (CONTACTS, topics(two("/l_gripper_{}_finger_bumper_vals", "l", "r"))),
    "two arms by their make": (WRENCHES, topics(two("/{}_ur5/wrench"))),
    "wheels": (WRENCHES, topics(legs("/wheel_{}/wrench", 1))),
    "head": (WRENCHES, ["/head/ft", "/neck_ft"]),
    "flippers": (WRENCHES, topics(legs("/{}_flipper/force", 3))),
    "outriggers of a crane": (WRENCHES, topics(legs("/crane/outrigger_{}/force", 1))),
}


@pytest.mark.parametrize("name", CLEAR)
def test_clear_feet_are_found(name: str) -> None:
    contacts_only, feet, others = CLEAR[name]
    found = name_feet([*others, *feet.values()], contacts_only=contacts_only)
    assert told(found.chosen) == feet
    assert list(told(found.chosen)) == sorted(feet, key=list(feet).index)


@pytest.mark.parametrize("name", UNSURE)
def test_feet_that_are_not_sure_are_offered(name: str) -> None:
    contacts_only, given_topics, likely = UNSURE[name]
    found = name_feet(given_topics, contacts_only=contacts_only)
    assert found.chosen is None
    assert told(found.offered[0]) == likely
    assert {topic for one in found.offered for topic in one.topics} == set(given_topics)


@pytest.mark.parametrize("name", NO_FEET)
def test_what_is_no_foot_is_neither_chosen_nor_offered(name: str) -> None:
    contacts_only, given_topics = NO_FEET[name]
    found = name_feet(given_topics, contacts_only=contacts_only)
    assert (found.chosen, found.offered) == (None, ())


def test_what_was_not_chosen_is_offered_beside_it() -> None:
    contacts_only, _, others = CLEAR["hrpsys offset"]
    found = name_feet([*topics(CLEAR["hrpsys offset"][1]), *others], contacts_only=contacts_only)
    assert [told(one)["left"] for one in found.offered] == ["/lfsensor", "/ref_lfsensor"]


def test_legs_without_a_topic_are_named() -> None:
    found = name_feet(CLEAR["three of four"][1].values(), contacts_only=True)
    assert found.chosen is not None
    assert found.chosen.missing == ("back_right",)


PREFIXES = (
    "/rl_controller",
    "/robot_1",
    "/feedback/left_lab",
    "/back",
    "/fl",
    "/left_leg_controller",
    "/my_arm/x",
    "/FrontEnd",
)
SUFFIXES = ("/data", "_raw", "/state", "/topic_2", "/rr", "/left", "/front")


@given(
    name=st.sampled_from(sorted(CLEAR)),
    prefix=st.lists(st.sampled_from(PREFIXES), max_size=3).map("".join),
    suffix=st.sampled_from(("", *SUFFIXES)),
    order=st.randoms(use_true_random=False),
)
def test_what_all_names_share_changes_nothing(
    name: str, prefix: str, suffix: str, order: Random
) -> None:
    contacts_only, feet, others = CLEAR[name]

    def longer(topic: str) -> str:
        return f"{prefix}{'/' if prefix and topic[0] != '/' else ''}{topic}{suffix}"

    names = [longer(topic) for topic in (*feet.values(), *others)]
    order.shuffle(names)
    found = name_feet(names, contacts_only=contacts_only)
    assert told(found.chosen) == {leg: longer(topic) for leg, topic in feet.items()}


@given(name=st.sampled_from(sorted(UNSURE)), order=st.randoms(use_true_random=False))
def test_the_order_of_topics_changes_nothing(name: str, order: Random) -> None:
    contacts_only, given_topics, _ = UNSURE[name]
    shuffled = [*given_topics]
    order.shuffle(shuffled)
    assert name_feet(shuffled, contacts_only=contacts_only) == name_feet(
        given_topics, contacts_only=contacts_only
    )


@given(st.lists(st.text(max_size=20), max_size=8), st.booleans())
def test_any_names_will_do(names: list[str], contacts_only: bool) -> None:  # noqa: FBT001
    found = name_feet(names, contacts_only=contacts_only)
    sets = [*([found.chosen] if found.chosen else []), *found.offered]
    for one in sets:
        assert one.topics <= set(names)
        assert all(name.replace("_", "").isalnum() for name in told(one))
        assert len(told(one)) == len(one.feet)


@pytest.mark.parametrize(
    "pattern", ["/leg_{}", "/left/left/left_lf_lf_front_left_front_left_{}", "/x{}/left_foot"]
)
def test_many_names_come_to_an_end(pattern: str) -> None:
    """Comparing each name with each other one would take hours."""
    name_feet([pattern.format(number) for number in range(6_000)], contacts_only=True)


@pytest.mark.parametrize(
    ("name", "position"),
    [
        ("/lf_foot/contacts", ("front", "left")),
        ("/RH", ("back", "right")),
        ("/rr_bumper", ("back", "right")),
        ("/frontLeftFoot", ("front", "left")),
        ("/hind-right", ("back", "right")),
        ("/fore/right", ("front", "right")),
        ("/rear_left_toe", ("back", "left")),
        ("/leg/middle_left", ("middle", "left")),
        ("/ml/contact", ("middle", "left")),
        ("/feedback/left", None),
        ("/front_back_left", None),
        ("/left_right_front", None),
        ("/foot_1", None),
        ("", None),
    ],
)
def test_a_leg_s_position_by_its_name(name: str, position: tuple[str, str] | None) -> None:
    assert leg_position(name) == position


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("/leftFootSixAxis_Offset", "left foot six axis offset"),
        ("/LFoot/FTSensor2", "l foot ft sensor 2"),
        ("/FLfoot", "fl foot"),
        ("/RHFoot", "rh foot"),
        ("/off_lfsensor", "off left foot sensor"),
        ("/rhsensor", "right hand sensor"),
        ("/frontleft-contact", "front left contact"),
        ("/feedback/forearm.copyright", "feedback forearm copyright"),
        ("/leg_1", "leg 1"),
    ],
)
def test_words(name: str, words: str) -> None:
    assert " ".join(word.text for word in words_of(name)) == words
