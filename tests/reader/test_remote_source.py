"""Logs in a store: only what is asked for is fetched."""

import http.server
import threading
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any, ClassVar

import pytest
from upath import UPath

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.info import describe
from dogbot_logtool.errors import CallError, StoreError
from dogbot_logtool.io import storage
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.options.info import InfoOptions
from dogbot_logtool.reader.containers.source import RemoteSource
from dogbot_logtool.reader.opening import open_log
from dogbot_logtool.report.info_report import info_json
from tests.oracles.small_logs import odometry_log
from tests.paths import SAMPLE_LOGS


class Server(http.server.SimpleHTTPRequestHandler):
    """Serves files by range; may fail or fall short."""

    folder: ClassVar[Path]
    sent: ClassVar[list[int]]
    is_short: ClassVar[bool]
    status: ClassVar[int]
    """That of all answers; 0: as it should be."""

    def send_head(self) -> BytesIO | None:
        """Return the piece that is asked for; none is there if an error is sent."""
        file = self.folder / self.path.lstrip("/")
        if status := self.status or (0 if file.exists() else 404):
            self.send_error(status)
            return None
        data, is_asked = file.read_bytes(), self.command == "GET"
        wanted = self.headers.get("Range", f"bytes=0-{len(data) - 1}").removeprefix("bytes=")
        first, _, last = wanted.partition("-")
        piece = data[int(first) : int(last or len(data) - 1) + 1]
        self.send_response(206 if is_asked else 200)
        self.send_header("Accept-Ranges", "bytes")
        self.send_header("Content-Range", f"bytes {first}-{last}/{len(data)}")
        self.send_header("Content-Length", str(len(piece)))
        self.end_headers()
        self.sent.extend([len(piece)] * is_asked)
        return BytesIO(piece[: len(piece) // 2] if self.is_short else piece)

    def log_message(self, *_words: object) -> None:
        """Say nothing."""


class RoomyServer(http.server.ThreadingHTTPServer):
    """Keeps many connections waiting, as a large server does."""

    request_queue_size = 128


@pytest.fixture
def url(tmp_path: Path) -> Iterator[str]:
    Server.folder, Server.sent, Server.is_short, Server.status = tmp_path, [], False, 0
    server = RoomyServer(("127.0.0.1", 0), Server)
    thread = threading.Thread(target=server.serve_forever, args=(0.02,))
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()
    thread.join()
    server.server_close()


def facts_of(place: Any) -> dict[str, Any]:
    told = info_json(describe(place, InfoOptions()))
    return {key: value for key, value in told.items() if key != "path"}


def test_info_reads_an_index_and_a_few_chunks(tmp_path: Path, url: str) -> None:
    log = odometry_log(tmp_path / "log.mcap", "/odom", filler=3)
    assert log.stat().st_size > 30_000_000

    assert facts_of(storage.location(f"{url}/log.mcap")) == facts_of(log)

    # Every chunk but those of noise alone is looked into.
    assert sum(Server.sent) < 12_000_000


def test_a_part_of_a_log_is_all_that_is_read(tmp_path: Path, url: str) -> None:
    log = odometry_log(tmp_path / "log.mcap", "/odom", filler=3)
    options = ConvertOptions(start=4.0, end=4.5, overwrite=True)
    convert(log, tmp_path / "here.mcap", options)
    place = storage.location(f"{url}/log.mcap")
    describe(place, InfoOptions())
    look = sum(Server.sent)
    Server.sent.clear()

    convert(place, tmp_path / "there.mcap", options)

    assert (tmp_path / "there.mcap").read_bytes() == (tmp_path / "here.mcap").read_bytes()
    assert sum(Server.sent) - look < 6_000_000


@pytest.mark.parametrize("name", ["dogbot_trot.bag", "dogbot_troubled.bag", "dogbot_walk.mcap"])
def test_a_log_is_the_same_wherever_it_lies(tmp_path: Path, url: str, name: str) -> None:
    data = (SAMPLE_LOGS / name).read_bytes()
    whole, cut = tmp_path / name, tmp_path / f"cut.{name}"
    whole.write_bytes(data)
    cut.write_bytes(data[: len(data) * 2 // 3])
    for log in (whole, cut):
        assert facts_of(storage.location(f"{url}/{log.name}")) == facts_of(log)


@pytest.mark.parametrize("is_short", [False, True])
def test_what_is_asked_for_is_had_or_an_error(tmp_path: Path, url: str, *, is_short: bool) -> None:
    (tmp_path / "x.bag").write_bytes(b"0123456789")
    place = storage.location(f"{url}/x.bag")
    assert isinstance(place, UPath)
    source = RemoteSource(place, storage.facts(place))
    assert source.read(10, 1) == source.read(-1, 2) == b""
    if is_short:
        Server.is_short = True
        with pytest.raises(StoreError, match=r"x\.bag: the store fails"):
            source.read(2, 4)
    else:
        assert source.read(2, 4) == b"2345"
        assert source.read(8, 99) == b"89"


def test_a_server_that_sends_whole_files_is_said(
    tmp_path: Path, url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "x.bag").write_bytes(b"#ROSBAG V2.0\n" + bytes(2 << 20))
    monkeypatch.setattr(Server, "parse_request", _without_range)
    with pytest.raises(StoreError, match="sends other parts than are asked for; download the"):
        open_log(storage.location(f"{url}/x.bag"))


def _without_range(request: Server) -> bool:
    """Parse a request, but for the range that it asks for."""
    is_sound = http.server.BaseHTTPRequestHandler.parse_request(request)
    del request.headers["Range"]
    return is_sound


@pytest.mark.parametrize(
    ("status", "error", "words"),
    [
        (403, CallError, "the store refuses the request: 403 Forbidden"),
        (404, CallError, "no such file"),
        (400, CallError, "the store refuses the request: 400 Bad Request"),
        (500, StoreError, "the store fails: 500 Internal Server Error"),
    ],
)
def test_what_a_server_answers_is_said(
    url: str, status: int, error: type[Exception], words: str
) -> None:
    Server.status = status
    with pytest.raises(error) as raised:
        open_log(UPath(f"{url}/x.mcap?Signature=secret"))
    assert str(raised.value) == f"{url}/x.mcap: {words}"


def test_a_server_that_cannot_be_reached_is_no_missing_file() -> None:
    with pytest.raises(StoreError, match=r"127\.0\.0\.1"):
        open_log(UPath("http://127.0.0.1:1/x.mcap"))
