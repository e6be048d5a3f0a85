"""Tables are taken by pandas, Polars and Arrow as they are."""

import numpy as np
import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

from dogbot_logtool.api import table
from dogbot_logtool.api.table import Table
from dogbot_logtool.errors import LogtoolError


@pytest.fixture
def small() -> Table:
    return Table(
        {
            "foot": np.array(["left", None], np.object_),
            "force_n": np.array([1.5, np.nan]),
            "in_contact": np.array([True, False]),
        }
    )


def test_columns_by_name(small: Table) -> None:
    assert len(small) == 2
    assert list(small) == ["foot", "force_n", "in_contact"]
    assert small["in_contact"].tolist() == [True, False]
    assert repr(small) == "<Table of 2 rows: foot, force_n, in_contact>"
    assert len(Table({})) == 0


def test_a_wrong_column_lists_those_that_exist(small: Table) -> None:
    with pytest.raises(KeyError, match="the columns are foot, force_n, in_contact"):
        small["forces"]


def test_pandas_gets_columns_of_its_own(small: Table) -> None:
    frame = small.to_pandas()
    assert isinstance(frame, pd.DataFrame)
    assert frame["in_contact"].tolist() == [True, False]
    frame.loc[0, "force_n"] = 2.0
    assert small["force_n"][0] == 1.5


def test_arrow_has_null_for_what_is_not_known(small: Table) -> None:
    arrow = small.to_arrow()
    assert arrow["force_n"].to_pylist() == [1.5, None]
    assert arrow["foot"].to_pylist() == ["left", None]


def test_what_takes_arrow_takes_a_table_as_it_is(small: Table) -> None:
    assert pa.table(small) == small.to_arrow()
    assert pl.DataFrame(small)["force_n"].to_list() == [1.5, None]


def test_a_missing_package_is_named(small: Table, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(table, "import_module", missing)
    with pytest.raises(LogtoolError, match="pip install pandas"):
        small.to_pandas()
