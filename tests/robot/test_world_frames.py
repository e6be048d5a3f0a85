"""Forces and places that the log's own frames tell, from log to arrow."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

import dogbot_logtool as dl
from dogbot_logtool.results import Conversion
from tests.oracles import walks
from tests.oracles.annotated_file import arrows
from tests.oracles.frames import matrix_of

WRENCHES = "geometry_msgs/msg/WrenchStamped"
COUNTS = "unitree_go/msg/LowState"


def counted(done: Conversion, what: str) -> int:
    """The number after the colon in the text of a note or warning."""
    found = {finding.text for finding in done.findings if finding.code == "TRANSFORMS_MISSING"}
    (text,) = (text for text in found if what in text and ": " in text)
    return int(text.split(": ")[1].split(";")[0].replace(",", ""))


class SwingingSensors(walks.Walk):
    """Sensors that turn about y at 2 rad/s, told in frames that hang from the base."""

    def pitch(self, sample: int) -> float:
        return 2.0 * sample * walks.STEP / 1e9

    def contacts(self, kind: str, sample: int) -> Iterator[tuple[str, Any]]:
        self.turned_by = self.pitch(sample)
        return super().contacts(kind, sample)

    def wrench(self, values: Any) -> Any:
        x, y, z = values
        cos, sin = np.cos(self.turned_by), np.sin(self.turned_by)
        return super().wrench((cos * x - sin * z, y, sin * x + cos * z))

    def frames(self) -> Iterator[walks.Entry]:
        """Every 20 ms, sent 30 ms late."""
        kind = "tf2_msgs/msg/TFMessage"
        for sample in range(0, walks.SAMPLES, 2):
            half = self.pitch(sample) / 2
            turn = 0.0, np.sin(half), 0.0, np.cos(half)
            transforms = [
                {
                    "header": self.header(sample, "base"),
                    "child_frame_id": f"{leg}_sensor",
                    "transform": {"translation": (place, -place, -0.4), "rotation": turn},
                }
                for place, leg in enumerate(walks.LEGS)
            ]
            data = self.bytes_of(kind, self.make(kind, transforms=transforms))
            time = walks.START + (sample + 3) * walks.STEP
            yield walks.Entry("/tf", kind, time, data)


class Swinging:
    """A log of swinging sensors, and what is made of it."""

    def __init__(self, folder: Path, kind: str) -> None:
        self.walk, self.kind, self.folder = SwingingSensors(2), kind, folder
        self.frames = list(self.walk.frames())
        self.robot = walks.robot_file(folder, kind)
        self.target = folder / "out.mcap"

    def converted(self, style: Literal["pressure", "force"] = "force") -> Conversion:
        entries = sorted([*self.frames, *self.walk.messages(self.kind)], key=lambda e: e.log_time)
        log, robot = walks.write_log(self.folder, self.walk, entries), str(self.robot)
        return dl.convert(log, self.target, encoding="ros2", copy=False, robot=robot, style=style)

    def arrows(self) -> Iterator[tuple[str, int, Any]]:
        """Each arrow's leg, the sample that it is of, and its marker."""
        for topic, log_time, marker in arrows(self.target):
            (leg,) = (leg for leg in walks.LEGS if leg in topic)
            yield leg, round((log_time - walks.START) / walks.STEP), marker


@pytest.mark.parametrize("until_s", [None, 3.0])
def test_arrows_of_force_sensors_stand_at_their_frames_along_the_force(
    tmp_path: Path, until_s: float | None
) -> None:
    """As long as there are frames; the rest is left where it is."""
    made, last = Swinging(tmp_path, WRENCHES), walks.SAMPLES
    if until_s is not None:
        end = walks.START + round(until_s * 1e9)
        made.frames = [entry for entry in made.frames if entry.log_time < end]
        last = (made.frames[-1].log_time - walks.START) // walks.STEP - 3
    done = made.converted()
    count = 0
    for leg, sample, marker in made.arrows():
        drawn = 100.0 * marker.scale.x * matrix_of(marker.pose.orientation)[:, 0]
        assert drawn == pytest.approx(walks.FORCES[leg][sample], abs=1e-5)
        place, position = walks.LEGS.index(leg), marker.pose.position
        assert (position.x, position.y, position.z) == pytest.approx(
            (0.003 * sample + place, -place, 0.0), abs=1e-9
        )
        count += 1
    assert count == sum(int(touch[: last + 1].sum()) for touch in walks.TOUCHES.values())
    assert counted(done, "forces turned") == counted(done, "placed at the origins") == count


def test_a_robot_s_file_names_frame_and_point_of_feet_that_only_count(tmp_path: Path) -> None:
    made = Swinging(tmp_path, COUNTS)
    text = made.robot.read_text(encoding="utf-8")
    for leg in walks.LEGS:
        named = f'[feet.{leg}]\nframe = "{leg}_sensor"\ncontact_point_m = [0.0, 0.5, 0.0]'
        text = text.replace(f"[feet.{leg}]", named)
    made.robot.write_text(text, encoding="utf-8")
    done = made.converted("pressure")
    seen = {(leg, sample): marker.pose.position for leg, sample, marker in made.arrows()}
    assert counted(done, "placed at the origins") >= len(seen) > 1000
    for (leg, sample), position in seen.items():
        place = walks.LEGS.index(leg)
        # Such messages have no stamps, so both stand at log times, and /tf comes 30 ms late.
        assert position.x == pytest.approx(0.003 * sample + place, abs=1e-9)
        assert position.y == pytest.approx(0.5 - place, abs=1e-9)
