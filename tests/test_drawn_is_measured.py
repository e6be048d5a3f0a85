"""What is drawn of a walk is what is measured of it, at every sample of the sample logs."""

from pathlib import Path

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.core.contact.stances import Cut, Stances
from dogbot_logtool.core.geometry.arrays import Flags, Ints
from dogbot_logtool.pipeline.options import ConvertOptions
from tests.measured import measured
from tests.oracles.annotated_file import Written, read_written, written_arrows, written_loads
from tests.paths import TROT, TROUBLED, WALK


@pytest.fixture(scope="module", params=[TROT, WALK, TROUBLED], ids=lambda log: log.stem)
def drawn(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Written]:
    target = tmp_path_factory.mktemp("drawn") / "out.mcap"
    convert(request.param, target, ConvertOptions(copy=False))
    return request.param, read_written(target)


def in_stance(stances: Stances, time: Ints) -> Flags:
    """(n,) whether measured stances hold some times; one that the log ends has its last sample."""
    begun = np.searchsorted(stances.touchdown, time, side="right") - 1
    behind = np.where(stances.cut == Cut.LOG_END, stances.liftoff + 1, stances.liftoff)
    ends = np.append(behind, np.iinfo(np.int64).min)
    held: Flags = time < ends[begun]
    return held


def test_every_sample_is_drawn_in_the_contact_state_that_is_measured(
    drawn: tuple[Path, Written],
) -> None:
    log, written = drawn
    for foot in measured(log).stats.feet:
        record = foot.record
        known = foot.contact_fraction is not None
        down = in_stance(record.stances, record.track.time)
        loads = {load.log_time: load for load in written_loads(written, foot.name, "foxglove")}
        arrows = {
            arrow.log_time: arrow
            for arrow in written_arrows(written, foot.name, "foxglove", "pressure")
        }
        assert len(record.log_time) > 400
        for log_time, is_down, force in zip(
            record.log_time.tolist(), down.tolist(), record.track.force.tolist(), strict=True
        ):
            if not known:
                continue
            assert loads[log_time].in_contact == is_down
            # A bounce within a stance has no force to draw.
            assert bool(arrows[log_time].position) == (is_down and force > 0.0)


def test_load_states_and_contact_say_the_same(drawn: tuple[Path, Written]) -> None:
    """Stances have the state `stance`, and silences, or a dead sensor, `unknown`."""
    log, written = drawn
    for foot in measured(log).stats.feet:
        states = written.of(f"/load/{foot.name}", "protobuf")
        assert len(states) >= len(foot.record.log_time)
        told = {b"stance": 0, b"swing": 0, b"unknown": 0}
        for _, message in states:
            told[next(word for word in told if word in message.data)] += 1
        if foot.contact_fraction is None:
            assert told[b"stance"] == told[b"swing"] == 0
        else:
            assert told[b"stance"] > 0
            assert told[b"swing"] > 0
