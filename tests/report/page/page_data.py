"""What a page holds, read back from its HTML."""

import base64
import json
import re
from typing import Any

import numpy as np


def drawings(html: bytes) -> dict[str, Any]:
    """Return the figures by name."""
    (text,) = re.findall(
        r'<script type="application/json" id="drawings">(.*?)</script>', html.decode(), re.DOTALL
    )
    return {each["name"]: each for each in json.loads(text)}


def numbers(column: Any) -> Any:
    """Return a column as an array: Plotly packs arrays in base64."""
    if isinstance(column, dict):
        packed = np.frombuffer(base64.b64decode(column["bdata"]), np.dtype(column["dtype"]))
        if "step" not in column:
            return packed
        known = np.where(packed == -32768, np.nan, packed)
        return (known + 32767.0) * column["step"] + column["lowest"]
    return np.array(column, np.float64)


def trace(drawing: Any, name: str) -> Any:
    """Return the one trace of a figure with a name."""
    (found,) = [each for each in drawing["data"] if each.get("name") == name]
    return found
