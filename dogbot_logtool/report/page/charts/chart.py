"""Charts as the plotting library of the page reads them: traces and a layout as plain values."""

import base64
from dataclasses import field
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from dogbot_logtool.dataclass import dataclass

Trace = dict[str, Any]
"""A trace of Plotly.js; arrays may be numpy's."""
_DTYPES: Final = {"float64": "f8", "float32": "f4", "int32": "i4", "int16": "i2", "int8": "i1"}
"""Names of types of packed arrays in Plotly.js."""


@dataclass(frozen=True, slots=True)
class Chart:
    """Traces and their layout, as Plotly.js documents them."""

    data: list[Trace] = field(default_factory=list)
    layout: dict[str, Any] = field(default_factory=dict)

    def plain(self) -> dict[str, Any]:
        """Return the chart as values that JSON has."""
        return {"data": _plain(self.data), "layout": _plain(self.layout)}


def scatter(**parts: Any) -> Trace:  # noqa: ANN401 - whatever Plotly.js documents
    """Return a trace of lines or markers."""
    return {"type": "scatter", **parts}


def bars(**parts: Any) -> Trace:  # noqa: ANN401 - whatever Plotly.js documents
    """Return a trace of horizontal bars."""
    return {"type": "bar", "orientation": "h", **parts}


def packed(values: NDArray[Any]) -> dict[str, Any]:
    """Return an array as Plotly.js reads it from base64; of types that it does not know, as f8."""
    known = values if values.dtype.name in _DTYPES else values.astype(np.float64)
    little = np.ascontiguousarray(known, known.dtype.newbyteorder("<"))
    found = {
        "dtype": _DTYPES[known.dtype.name],
        "bdata": base64.b64encode(little.tobytes()).decode(),
    }
    if known.ndim > 1:
        found["shape"] = ", ".join(str(each) for each in known.shape)
    return found


def _plain(value: Any) -> Any:  # noqa: ANN401 - any part of a chart
    if isinstance(value, np.ndarray):
        return packed(value)
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    return value
