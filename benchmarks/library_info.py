"""Counts a log's messages by topic from its index, with rosbags or the mcap library.

python benchmarks/library_info.py IN.bag|IN.mcap|http://...     a URL is downloaded first
"""

import sys
import tempfile
from pathlib import Path
from urllib.request import urlretrieve


def main(source: Path) -> None:
    """Print topic, type and count."""
    if source.suffix == ".mcap":
        from mcap.reader import make_reader  # noqa: PLC0415

        with source.open("rb") as file:
            summary = make_reader(file).get_summary()
        if summary is None or summary.statistics is None:
            raise SystemExit("no summary")
        counts = summary.statistics.channel_message_counts
        for channel in summary.channels.values():
            kind = summary.schemas[channel.schema_id].name
            print(channel.topic, kind, counts.get(channel.id, 0))
        return
    from rosbags.rosbag1 import Reader  # noqa: PLC0415

    with Reader(source) as reader:
        for topic, info in sorted(reader.topics.items()):
            print(topic, info.msgtype, info.msgcount)


if __name__ == "__main__":
    word = sys.argv[1]
    if word.startswith("http://"):
        with tempfile.TemporaryDirectory() as folder:
            target = Path(folder) / word.rpartition("/")[2]
            urlretrieve(word, target)  # noqa: S310 - http
            main(target)
    else:
        main(Path(word))
