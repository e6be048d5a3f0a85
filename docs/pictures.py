"""Takes the pictures of the documentation from the sample logs: ``make pictures``.

They are taken in a real browser, headless: of the page that `report` writes, and of annotated logs
in the open viewer that Foxglove published on npm, with the layout that `layout` writes. Needs
Chromium (its path in ``CHROMIUM``) and npm.
"""

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any, Final

from dogbot_logtool.commands.convert import convert
from dogbot_logtool.commands.layout import view_of
from dogbot_logtool.io.plain_json import to_json
from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.options.convert import ConvertOptions
from dogbot_logtool.report.layouts import foxglove_layout

PICTURES: Final = Path(__file__).parent / "pictures"
SAMPLES: Final = PICTURES.parents[1] / "sample_logs"
WORKSHOP: Final = PICTURES.parents[1] / "build" / "pictures"
"""Where the viewer is installed and logs are converted."""
CHROMIUM: Final = os.environ.get("CHROMIUM", "/usr/bin/chromium")
WAIT_MS: Final = 20_000
"""Until the viewer has drawn everything, on a slow machine too."""
SIZE: Final = {"width": 1280, "height": 720}
LOGS: Final = {"trot": ("dogbot_trot.bag", 0.43), "walk": ("dogbot_walk.mcap", 0.54)}
"""Log and share of its duration, by picture of the viewer."""
TROUBLED: Final = ("dogbot_troubled.bag", 0.57)


class RangeHandler(SimpleHTTPRequestHandler):
    """Serves files, and parts of them, as the viewer reads logs."""

    def do_GET(self) -> None:
        """Answer with the whole file, or with the bytes that are asked for."""
        path = Path(self.translate_path(self.path))
        if not path.is_file():
            super().do_GET()
            return
        size = path.stat().st_size
        asked = re.match(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        first = int(asked[1]) if asked else 0
        last = min(int(asked[2]), size - 1) if asked and asked[2] else size - 1
        self.send_response(206 if asked else 200)
        self.send_header("Content-Type", self.guess_type(str(path)))
        self.send_header("Accept-Ranges", "bytes")
        self.send_header("Content-Length", str(last - first + 1))
        if asked:
            self.send_header("Content-Range", f"bytes {first}-{last}/{size}")
        self.end_headers()
        with path.open("rb") as stream:
            stream.seek(first)
            self.wfile.write(stream.read(last - first + 1))

    def log_message(self, *args: Any) -> None:  # noqa: ANN401 - the base's own signature
        """Say nothing of each request."""


def install() -> None:
    """Install the viewer and what drives the browser, if they are not there yet."""
    WORKSHOP.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "viewer.html", "browser.mjs"):
        shutil.copy(PICTURES / name, WORKSHOP / name)
    if not (WORKSHOP / "node_modules").is_dir():
        npm = ["npm", "install", "--no-audit", "--no-fund", "--no-package-lock"]
        subprocess.run(npm, cwd=WORKSHOP, check=True)  # noqa: S603


def prepare() -> None:
    """Convert the sample logs, and write their layouts and a page."""
    for log, _ in (*LOGS.values(), TROUBLED):
        source, stem = SAMPLES / log, Path(log).stem
        convert(source, WORKSHOP / f"{stem}.mcap", ConvertOptions(overwrite=True))
        layout = foxglove_layout(view_of(source, MeasureOptions()))
        (WORKSHOP / f"{stem}.json").write_text(to_json(layout))
    page = ["report", str(SAMPLES / LOGS["trot"][0]), "-o", str(WORKSHOP / "report.html")]
    program = [sys.executable, "-m", "dogbot_logtool"]
    subprocess.run([*program, *page, "--overwrite"], check=True)  # noqa: S603


def pictures(server: str) -> Iterator[dict[str, Any]]:
    """Yield what is taken; see `browser.mjs`."""
    for name, (log, seek) in {**LOGS, "dropout": TROUBLED}.items():
        stem = Path(log).stem
        yield SIZE | {
            "url": f"{server}/viewer.html?layout={stem}.json&log={stem}.mcap",
            "file": str(PICTURES / f"viewer_{name}.png"),
            "seek": seek,
            "wait_ms": WAIT_MS,
            # Without the viewer's own bars.
            "clip": {"x": 51, "y": 0, "width": 1229, "height": 643},
        }
    yield SIZE | {
        "url": f"{server}/report.html",
        "file": str(PICTURES / "report.png"),
        "seek": None,
        "wait_ms": WAIT_MS // 4,
        "clip": None,
    }


def main() -> None:
    """Take all pictures."""
    install()
    prepare()
    handler = partial(RangeHandler, directory=str(WORKSHOP))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        wanted = list(pictures(f"http://127.0.0.1:{server.server_port}"))
        node = ["node", "browser.mjs", CHROMIUM, json.dumps(wanted)]
        subprocess.run(node, cwd=WORKSHOP, check=True)  # noqa: S603
        server.shutdown()


if __name__ == "__main__":
    main()
