"""The page lists events, each with the time that its button shows, and marks them in figures."""

from dogbot_logtool.commands.stats import measure
from dogbot_logtool.core.contact.curves import CurveDetail
from dogbot_logtool.pipeline.options import StatsOptions
from dogbot_logtool.report.page.event_list import event_list, marks
from dogbot_logtool.report.page.render import page
from tests.paths import SAMPLE_LOGS
from tests.report.page.page_data import drawings


def test_events_are_listed_and_marked_in_every_figure_over_time() -> None:
    options = StatsOptions(curves=CurveDetail())
    measured = measure(SAMPLE_LOGS / "dogbot_troubled.bag", options)
    found = event_list(measured.stats)
    assert [row.what for row in found.rows] == ["sensor fault", "gap"]
    html = page(measured.stats, measured.facts, [], 0)
    for row in found.rows:
        assert f'data-from="{row.start_s}" data-to="{row.end_s}"'.encode() in html
    over_time = [each for each in drawings(html).values() if each["over_time"]]
    assert len(over_time) == 3
    for each in over_time:
        spans = [(shape["x0"], shape["x1"]) for shape in each["layout"]["shapes"]]
        assert spans == [(row.start_s, row.end_s) for row in found.rows]
    assert len(marks(found)) == 2
