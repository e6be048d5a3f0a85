"""A real S3 API on loopback that can be told to fail: ``python -m tests.run.s3_server FOLDER``.

FOLDER/port is written once it listens. Every request is noted in FOLDER/requests.jsonl. Where
FOLDER/fail_every holds a number n, every n-th request of an object is answered with 503.
"""

import itertools
import json
import sys
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from moto.moto_server.werkzeug_app import DomainDispatcherApplication, create_backend_app
from werkzeug.serving import make_server

UNAVAILABLE = (
    b'<?xml version="1.0"?><Error><Code>ServiceUnavailable</Code>'
    b"<Message>Please try again.</Message></Error>"
)


class Unreliable:
    """Passes requests on, notes them, and fails some."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._app = DomainDispatcherApplication(create_backend_app)
        self._numbers = itertools.count(1)
        self._lock = threading.Lock()
        self._notes = (folder / "requests.jsonl").open("a")

    def __call__(
        self, environ: dict[str, Any], start_response: Callable[..., Any]
    ) -> Iterable[bytes]:
        fail_every = self._folder / "fail_every"
        number = int(fail_every.read_text()) if fail_every.exists() else 0
        failing = bool(number) and next(self._numbers) % number == 0
        note = {
            "method": environ["REQUEST_METHOD"],
            "path": environ["PATH_INFO"],
            "range": environ.get("HTTP_RANGE", ""),
            "failed": failing,
        }
        with self._lock:
            self._notes.write(json.dumps(note) + "\n")
            self._notes.flush()
        if failing:
            start_response("503 Service Unavailable", [("Content-Type", "application/xml")])
            return [UNAVAILABLE]
        answer: Iterable[bytes] = self._app(environ, start_response)
        return answer


def main() -> None:
    folder = Path(sys.argv[1])
    server = make_server("127.0.0.1", 0, Unreliable(folder), threaded=True)
    port = folder / "port.part"
    port.write_text(str(server.server_port))
    port.rename(folder / "port")
    server.serve_forever()


if __name__ == "__main__":
    main()
