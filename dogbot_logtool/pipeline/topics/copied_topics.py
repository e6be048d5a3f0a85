"""Which recorded topics `convert` copies: ``--topics`` and ``--without``."""

from collections.abc import Iterator, Sequence
from fnmatch import fnmatchcase

from dogbot_logtool.errors import CallError
from dogbot_logtool.finding import Finding, note, warning
from dogbot_logtool.io.listing import listed
from dogbot_logtool.pipeline.options import ConvertOptions
from dogbot_logtool.reader.containers.log import Log


def channels_left_out(log: Log, options: ConvertOptions) -> frozenset[int]:
    """Return the ids of the channels that are not copied; annotations are made of all.

    Raises:
        CallError: topics are chosen, but nothing is copied.
    """
    if not (options.copied_topics or options.topics_left_out):
        return frozenset()
    if not options.copy:
        raise CallError("--topics and --without choose what is copied; --no-copy copies nothing")
    return frozenset(
        channel.id
        for channel in log.channels.values()
        if (options.copied_topics and not _fits(channel.topic, options.copied_topics))
        or _fits(channel.topic, options.topics_left_out)
    )


def copy_findings(log: Log, options: ConvertOptions, left_out: frozenset[int]) -> Iterator[Finding]:
    """Say what is left out, and which patterns fit no topic."""
    topics = {channel.topic for channel in log.channels.values()}
    for option, globs in (
        ("--topics", options.copied_topics),
        ("--without", options.topics_left_out),
    ):
        for glob in globs:
            if not any(fnmatchcase(topic, glob) for topic in topics):
                yield warning("NO_SUCH_TOPICS", f"{option} {glob} fits no topic of the log")
    if left_out:
        names = sorted({log.channels[number].topic for number in left_out})
        messages = sum(log.counts.get(number, 0) for number in left_out)
        text = f"{messages:,} messages of topics left out of the copy: {listed(names)}"
        yield note("TOPICS_LEFT_OUT", text)


def _fits(topic: str, globs: Sequence[str]) -> bool:
    return any(fnmatchcase(topic, glob) for glob in globs)
