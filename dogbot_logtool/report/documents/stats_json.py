"""All figures of `stats` as plain data: the shape that `stats.schema.json` describes."""

from dogbot_logtool.core.statistics import Stats
from dogbot_logtool.finding import Finding
from dogbot_logtool.io.plain_json import not_finite, only_finite
from dogbot_logtool.io.printable import listed
from dogbot_logtool.report.figures.document import DOCUMENT, log_source
from dogbot_logtool.report.figures.figure import Json
from dogbot_logtool.report.figures.recording import finding_json
from dogbot_logtool.results import LogFacts


def stats_json(stats: Stats, log: LogFacts) -> Json:
    """Return all figures of one log as plain data; what is not known is None."""
    document: Json = DOCUMENT.plain(log_source(stats, log))
    finite: Json = only_finite(document)
    # Comparing is far quicker than looking for paths, of which there are nearly never any.
    if finite != document and (overflowed := list(not_finite(document))):
        text = f"figures that are too large for a number are null: {listed(overflowed)}"
        finite["findings"].append(finding_json(Finding("NOT_FINITE", text, cases=("result",))))
    return finite
