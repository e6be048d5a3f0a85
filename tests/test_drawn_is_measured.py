"""What is drawn of a walk is what is measured of it, at every sample of the sample logs."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.options.convert import ConvertOptions
from tests.measured import measured, measured_contact
from tests.oracles.annotated_file import Written, read_written, written_arrows, written_loads
from tests.paths import TROT, TROUBLED, WALK


@pytest.fixture(scope="module", params=[TROT, WALK, TROUBLED], ids=lambda log: log.stem)
def drawn(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Written, Mapping[str, int]]:
    target = tmp_path_factory.mktemp("drawn") / "out.mcap"
    done = convert(request.param, target, ConvertOptions(copy=False))
    return request.param, read_written(target), done.counts


def test_every_sample_is_drawn_in_the_contact_state_that_is_measured(
    drawn: tuple[Path, Written, Mapping[str, int]],
) -> None:
    log, written, counts = drawn
    missing = 0
    for foot in measured(log).walk.feet:
        contact = measured_contact(log, foot.name)
        loads = {load.log_time: load for load in written_loads(written, foot.name, "foxglove")}
        arrows = {
            arrow.log_time: arrow
            for arrow in written_arrows(written, foot.name, "foxglove", "pressure")
        }
        for log_time, is_down in ({} if contact is None else contact).items():
            assert loads[log_time].in_contact == is_down
            # A bounce within a stance has no force to draw.
            is_drawn = bool(arrows[log_time].position)
            assert is_drawn <= is_down
            missing += is_down and not is_drawn and loads[log_time].force > 0.0
        # Of a dead sensor nothing is known, and nothing is drawn.
        if contact is None:
            assert not any(arrow.position for arrow in arrows.values())
    # Points that are not finite; forces that are not are no samples that are measured.
    assert missing <= counts["not_finite"]
    assert (missing > 0) == (log == TROUBLED)


def test_load_states_and_contact_say_the_same(
    drawn: tuple[Path, Written, Mapping[str, int]],
) -> None:
    """Stances have the state `stance`, and silences, or a dead sensor, `unknown`."""
    log, written, _ = drawn
    for foot in measured(log).walk.feet:
        states = written.of(f"/load/{foot.name}", "protobuf")
        assert len(states) >= len(foot.record.track.log_time)
        told = {b"stance": 0, b"swing": 0, b"unknown": 0}
        for _, message in states:
            told[next(word for word in told if word in message.data)] += 1
        if foot.is_dead:
            assert told[b"stance"] == told[b"swing"] == 0
        else:
            assert told[b"stance"] > 0
            assert told[b"swing"] > 0
