"""Feet whose contact is told without a force: stance and swing are told all the same."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from dogbot_logtool.report.documents import stats_json
from tests.oracles import state_walks, walks
from tests.oracles.state_walks import StateWalk

SPOT, CHAMP = "spot_msgs/msg/FootStateArray", "champ_msgs/msg/ContactsStamped"


class Placed(StateWalk):
    """Spot's feet in the base's frame, where the drivers of the oracle leave them out."""

    def contacts(self, kind: str, sample: int) -> Any:
        for topic, message in super().contacts(kind, sample):
            if kind == SPOT:
                for leg, state in zip(walks.LEGS, message.states, strict=True):
                    at = state_walks.foot_position(leg, sample) - state_walks.base_position(sample)
                    state.foot_position_rt_body.x, state.foot_position_rt_body.y = at[:2].tolist()
                    state.foot_position_rt_body.z = float(at[2])
            yield topic, message


@pytest.mark.parametrize("kind", [SPOT, CHAMP])
def test_loads_say_stance_and_swing(tmp_path: Path, kind: str) -> None:
    walk, path, out = Placed(2), tmp_path / "walk.mcap", tmp_path / "out.mcap"
    walks.write_mcap(path, walk, list(walk.messages(kind)))
    convert(path, out, ConvertOptions(copy=False))
    found: Counter[tuple[str, bool]] = Counter()
    with out.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, _, message, load in reader.iter_decoded_messages(topics=["/load/front_left"]):
            down = walks.TOUCHES["front_left"][(message.log_time - walks.START) // walks.STEP]
            found[load.state, bool(down)] += 1
    down = int(walks.TOUCHES["front_left"].sum())
    assert found[("stance", True)] == down
    assert not found["swing", True]
    assert not found["stance", False]


def test_spot_s_feet_are_where_it_says(tmp_path: Path) -> None:
    walk, path = Placed(2), tmp_path / "walk.mcap"
    walks.write_mcap(path, walk, list(walk.messages(SPOT)))
    done = measure(path, MeasureOptions())
    feet = stats_json(done)["feet"]
    for leg in walks.LEGS:
        assert feet[leg]["stride_length_m"]["median"] == pytest.approx(
            0.003 * walks.PERIOD, abs=1e-5
        )
        places = done.walk.feet[walks.LEGS.index(leg)].record.track
        assert np.isfinite(places.point).any()
