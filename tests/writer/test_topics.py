"""Names of topics."""

from dogbot_logtool.writer.topics import arrow_topic, load_topic


def test_topics_of_feet() -> None:
    assert arrow_topic("front_left") == "/marker_basic_front_left_foot"
    assert load_topic("front_left") == "/load/front_left"
