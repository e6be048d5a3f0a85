"""Serves the files of a folder over HTTP, parts of them too, as over a line of 50 MB/s.

python benchmarks/serve.py FOLDER      prints its URL
"""

import sys
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Final

_BYTES_A_SECOND: Final = 50_000_000
_PIECE: Final = 1 << 20


class Handler(BaseHTTPRequestHandler):
    """Answers for one file."""

    protocol_version = "HTTP/1.1"

    def do_HEAD(self) -> None:
        """Tell the size."""
        self._answer(with_body=False)

    def do_GET(self) -> None:
        """Send the file, or the part that is asked for."""
        self._answer(with_body=True)

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002 - its name
        """Say nothing."""

    def _answer(self, *, with_body: bool) -> None:
        path = Path(sys.argv[1]) / Path(self.path).name
        size = path.stat().st_size
        wanted = self.headers.get("Range")
        first, _, last = (wanted or "bytes=0-").removeprefix("bytes=").partition("-")
        start, end = int(first), min(int(last) + 1 if last else size, size)
        self.send_response(206 if wanted else 200)
        self.send_header("Accept-Ranges", "bytes")
        self.send_header("Content-Length", str(end - start))
        if wanted:
            self.send_header("Content-Range", f"bytes {start}-{end - 1}/{size}")
        self.end_headers()
        if with_body:
            self._send(path, start, end)

    def _send(self, path: Path, start: int, end: int) -> None:
        with path.open("rb") as file:
            file.seek(start)
            while start < end:
                piece = file.read(min(_PIECE, end - start))
                self.wfile.write(piece)
                start += len(piece)
                time.sleep(len(piece) / _BYTES_A_SECOND)


if __name__ == "__main__":
    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    print(f"http://127.0.0.1:{server.server_port}", flush=True)
    server.serve_forever()
