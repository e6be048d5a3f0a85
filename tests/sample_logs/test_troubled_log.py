"""The log with damage has the damage that its truth lists, and no other."""

from typing import Any

import numpy as np
import pytest

from tests.sample_logs.decoded_logs import (
    FEET,
    ODOMETRY,
    TROUBLED,
    Log,
    by_number,
    contact_topic,
    has_stamp,
    newest_step,
    read_log,
    seconds,
    stamp_ns,
)


class TestTroubledLog:
    """Every damage that the truth lists is there, and no other."""

    @pytest.fixture
    def log(self) -> Log:
        return read_log(TROUBLED)

    @pytest.fixture
    def damage(self, log: Log) -> dict[str, Any]:
        listed: dict[str, Any] = log.truth["damage"]
        return listed

    def test_all_stamps_are_zero(self, log: Log, damage: dict[str, Any]) -> None:
        assert damage["zero_stamps"]
        for topic, messages in log.topics.items():
            for _, message in messages:
                if not has_stamp(message):
                    continue
                headers = (
                    [link.header for link in message.transforms]
                    if topic == "/tf"
                    else [message.header]
                )
                assert {stamp_ns(header) for header in headers} == {0}

    def test_frames_have_leading_slashes_or_no_name(self, log: Log) -> None:
        for message in log.messages(ODOMETRY):
            assert (message.header.frame_id, message.child_frame_id) == ("/world", "")

    def test_the_dead_foot_never_touches(self, log: Log, damage: dict[str, Any]) -> None:
        messages = log.contacts(damage["dead_foot"])
        assert len(messages) == 501
        assert not any(message.states for message in messages)

    def test_the_silent_foot_stops_in_stance(self, log: Log, damage: dict[str, Any]) -> None:
        silence = damage["silence"]
        entries = log.topics[silence["topic"]]
        times_s = np.array([seconds(log, time_ns) for time_ns, _ in entries])
        before = int(np.argmax(np.diff(times_s)))
        interval_s = log.truth["log"]["contact_interval_s"]
        assert times_s[before] < silence["start_s"] < times_s[before] + 2 * interval_s
        gap_s = times_s[before + 1] - times_s[before]
        assert gap_s == pytest.approx(silence["duration_s"] + interval_s, abs=1e-3)
        assert entries[before][1].states

    def test_non_finite_numbers_are_where_the_truth_says(
        self, log: Log, damage: dict[str, Any]
    ) -> None:
        for foot in FEET:
            topic = contact_topic(foot)
            not_numbers, infinite = [], []
            for _, message in by_number(log, topic):
                for state in newest_step(message):
                    if np.isnan(state.total_wrench.force.z):
                        not_numbers.append(message.header.seq)
                    if np.isinf(state.contact_positions[0].x):
                        infinite.append(message.header.seq)
            assert not_numbers == damage["nan_force"].get(topic, [])
            assert infinite == damage["infinite_position"].get(topic, [])

    def test_one_quaternion_is_zero(self, log: Log, damage: dict[str, Any]) -> None:
        norms = [
            np.linalg.norm([q.x, q.y, q.z, q.w])
            for _, message in by_number(log, ODOMETRY)
            for q in [message.pose.pose.orientation]
        ]
        assert (
            np.flatnonzero(np.array(norms) == 0).tolist() == (damage["zero_quaternion"][ODOMETRY])
        )

    def test_log_times_repeat_and_go_back_where_the_truth_says(
        self, log: Log, damage: dict[str, Any]
    ) -> None:
        for topic in (ODOMETRY, *map(contact_topic, FEET)):
            entries = by_number(log, topic)
            numbers = np.array([message.header.seq for _, message in entries])[1:]
            steps_ns = np.diff([time_ns for time_ns, _ in entries])
            repeated = damage["duplicate_log_time"].get(topic, [])
            backward = damage["backward_log_time"].get(topic, [])
            assert numbers[steps_ns == 0].tolist() == repeated
            assert numbers[steps_ns < 0].tolist() == backward
