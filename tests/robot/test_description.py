"""Which robot descriptions are read, and which files are refused."""

from contextlib import closing
from pathlib import Path

import pytest

from dogbot_logtool.errors import CallError
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.robot.description import own_description, read_urdf
from tests.oracles.mcap_channels import SentChannel, write_channels


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"no xml", "is no XML"),
        (b"<robot", "is no XML"),
        (b"<sdf/>", "'robot'"),
        (b"\xff\xfe<robot/>", "UTF-8"),
        (b"\x7fELF\x02\x01\x01\0\0", "is no XML"),
        (
            b'<!DOCTYPE robot [<!ENTITY a SYSTEM "file:///etc/passwd">]><robot>&a;</robot>',
            "entities",
        ),
        (b"<robot/>" + b" " * (17 << 20), "larger"),
    ],
)
def test_what_is_no_urdf_is_refused(content: bytes, why: str, tmp_path: Path) -> None:
    file = tmp_path / "x.urdf"
    file.write_bytes(content)
    with pytest.raises(CallError, match=why):
        read_urdf(file)


def test_a_description_that_cannot_be_decoded_is_none(tmp_path: Path) -> None:
    message = 1, b'{"data": "<robot/>"}'
    sent = SentChannel("/robot_description", "std_msgs/String", "json", messages=[message])
    with closing(open_log(write_channels(tmp_path / "log.mcap", [sent]))) as log:
        assert own_description(log) is None
