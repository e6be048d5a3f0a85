"""The page lists events, each with the time that its button shows, and marks them in figures."""

import pytest

from dogbot_logtool.options import MeasureOptions
from dogbot_logtool.report.page.event_list import event_list
from dogbot_logtool.report.page.render import page
from tests.measured import measured
from tests.paths import SAMPLE_LOGS
from tests.report.page.page_data import drawings


def test_events_are_listed_and_marked_in_every_figure_over_time() -> None:
    options = MeasureOptions()
    troubled = measured(SAMPLE_LOGS / "dogbot_troubled.bag", options)
    found = event_list(troubled.walk)
    assert [row.what for row in found.rows] == ["sensor fault", "gap"]
    html = page(troubled, 0)
    for row in found.rows:
        assert f'data-from="{row.start_s}" data-to="{row.end_s}"'.encode() in html
    over_time = {name: each for name, each in drawings(html).items() if each["over_time"]}
    assert set(over_time) == {"gait", "loads", "motion", "commands"}
    for name, each in over_time.items():
        shapes = each["layout"]["shapes"]
        spans = [(shape["x0"], shape["x1"]) for shape in shapes]
        assert spans == [(row.start_s, row.end_s) for row in found.rows]
        # Of four feet the third is dead and the second silent: their events stand in their rows.
        middles = [(shape["y0"] + shape["y1"]) / 2.0 for shape in shapes]
        in_rows = name in {"gait", "loads"}
        wanted = [0.375, 0.625] if in_rows else [0.5, 0.5]
        assert middles == pytest.approx(wanted, abs=0.02)
    (label,) = over_time["gait"]["layout"]["annotations"]
    assert label["text"] == "sensor fault"
