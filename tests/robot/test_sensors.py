"""Sensors learnt from a whole log: offsets come off in `stats` and in `convert` alike."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.stats import measure
from dogbot_logtool.errors import CallError
from dogbot_logtool.options import ConvertOptions, MeasureOptions
from dogbot_logtool.report.documents import stats_json
from tests.truth import sensor_faults as sensor
from tests.truth.log_file import write_log
from tests.truth.recorders import recorder
from tests.truth.walking import Walk

OFFSET = (4.0, -6.0, -40.0)


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A trot of 20 kg whose force sensors read 40 N too little."""
    faults = (sensor.as_force_sensors, sensor.noise(1.0), sensor.offset(OFFSET))
    path: Path = write_log(recorder(Walk(), *faults)(), tmp_path_factory.mktemp("log") / "l.mcap")
    return path


def figures(log: Path, **options: Any) -> dict[str, Any]:
    done = measure(log, MeasureOptions(**options))
    return stats_json(done)


def test_offsets_are_estimated_and_reported(log: Path) -> None:
    got = figures(log, mass=20.0)
    for name, foot in got["quality"]["feet"].items():
        assert foot["force_offset_n"] == pytest.approx(OFFSET, abs=0.5)
        assert foot["force_noise_n"] == pytest.approx(1.0, rel=0.2)
        assert got["feet"][name]["contact_fraction"] == pytest.approx(0.6, abs=0.03)
    assert {each["offset_from"] for each in got["settings"]["feet"].values()} == {"estimated"}
    assert "SENSOR_OFFSET" in {each["code"] for each in got["findings"]}


def test_a_given_offset_stands(log: Path) -> None:
    name = "front_left"
    got = figures(log, mass=20.0, set={f"tare.{name}": "4,-6,-40"})
    assert got["quality"]["feet"][name]["force_offset_n"] == list(OFFSET)
    assert got["settings"]["feet"][name]["offset_from"] == "option"
    assert got["settings"]["feet"]["front_right"]["offset_from"] == "estimated"


def test_offsets_stay_in_if_asked(log: Path) -> None:
    got = figures(log, mass=20.0, set={"tare": "none"})
    for name, foot in got["quality"]["feet"].items():
        assert foot["force_offset_n"] == [0.0, 0.0, 0.0]
        assert got["feet"][name]["contact_fraction"] > 0.9


def test_without_a_mass_the_weight_is_estimated(log: Path) -> None:
    got = figures(log)
    on = got["settings"]["feet"]["front_left"]["contact_on_n"]
    assert on == pytest.approx(0.08 * 20.0 * 9.81, rel=0.03)
    assert got["forces"]["vertical_impulse_over_weight"] is None
    assert "MASS_UNKNOWN" in {each["code"] for each in got["findings"]}


def test_an_offset_of_no_foot_is_refused(log: Path) -> None:
    with pytest.raises(CallError, match=r"--set tare\.nose"):
        figures(log, set={"tare.nose": "4,-6,-40"})


def test_loads_are_drawn_without_offsets(log: Path, tmp_path: Path) -> None:
    from mcap.reader import make_reader  # noqa: PLC0415
    from mcap_protobuf.decoder import DecoderFactory  # noqa: PLC0415

    target = tmp_path / "out.mcap"
    convert(log, target, ConvertOptions(mass=20.0))
    with target.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        loads = [
            message.decoded_message.force
            for message in reader.iter_decoded_messages(topics=["/load/front_left"])
        ]
    force = np.array(loads)
    assert np.mean(force == 0.0) == pytest.approx(0.4, abs=0.03)
