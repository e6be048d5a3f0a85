"""The gait as it changes, in logs where there is none."""

from dogbot_logtool.core.events.event import Event, EventType
from dogbot_logtool.core.events.log_messages import _message, event_messages, gait_states
from dogbot_logtool.core.settings import WalkSettings
from tests.analysed import analysed


def test_a_log_without_feet_has_no_gait() -> None:
    stats = analysed(WalkSettings(feet=()))
    assert gait_states(stats) == ()
    assert event_messages(stats) == ()


def test_a_log_panel_shows_each_fact_once() -> None:
    """The panel writes the source before the text."""
    slip = Event(10, 20_000_000, EventType.SLIP, foot=1, value=0.012, unit="m", code="")
    gap = Event(10, 1_010_000_000, EventType.GAP, foot=0, value=1.01, unit="s", code="")
    found = [_message(each, ["left", "right"]) for each in (slip, gap)]
    assert [(each.source, each.text) for each in found] == [
        ("right", "slip, 0.012 m, for 0.020 s"),
        ("left", "gap, 1.01 s"),
    ]
