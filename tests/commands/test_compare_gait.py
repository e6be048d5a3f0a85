"""`compare --gait` as a user calls it, on the sample logs."""

from pathlib import Path

from dogbot_logtool.commands.tasks import figures
from dogbot_logtool.comparison.walks import compare_walks
from dogbot_logtool.options import MeasureOptions
from tests.forked_cli import run
from tests.paths import TROT, WALK
from tests.truth import sensor_faults
from tests.truth.log_file import write_log
from tests.truth.recording import disturbed
from tests.truth.walking import Walk as TrueWalk


def test_two_halves_of_a_run_walk_alike(tmp_path: Path) -> None:
    faults = (sensor_faults.as_force_sensors, sensor_faults.noise(1.0))
    log = write_log(
        disturbed(TrueWalk(seconds=20.0).recorded(200.0, 100.0), *faults), tmp_path / "log.mcap"
    )
    halves = [
        figures(log, options=MeasureOptions(mass=20.0, start=start, end=end))
        for start, end in ((0.0, 10.0), (10.0, 20.0))
    ]
    found = compare_walks(*([half] for half in halves))

    assert found.reasons == ()
    assert found.differing == ()
    assert len(found.differences) > 20


def test_another_gait_is_not_comparable(tmp_path: Path) -> None:
    ended = run("compare", "--gait", str(TROT), str(WALK), folder=tmp_path)

    assert ended.returncode == 1
    assert ended.stdout == "not comparable\n  the gaits differ: trot against walk\n"
