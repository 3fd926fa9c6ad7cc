"""Numbers of the JSON as they stand on the page: taken by their path, never computed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from .markup import Element, node

TIMES: Final = "\N{MULTIPLICATION SIGN}"
_CLOSE_UNITS: Final = ("°", "%", TIMES)


@dataclass(frozen=True, slots=True)
class Numbers:
    """The JSON of a job, read by JSON pointer (RFC 6901, keys without ``~`` and ``/``)."""

    summary: Mapping[str, Any]
    """What NAME.json holds."""

    def get(self, path: str) -> Any:
        """Returns the value at a path; None where a part of it is missing."""
        value: Any = self.summary
        for part in path.strip("/").split("/"):
            if isinstance(value, Mapping):
                value = value.get(part)
            elif isinstance(value, Sequence) and not isinstance(value, str):
                value = value[int(part)] if int(part) < len(value) else None
            else:
                return None
        return value

    def show(self, path: str, unit: str = "", digits: int | None = None) -> Element:
        """A number with its unit; a dash where the JSON has none.

        Args:
            path: its place in the JSON.
            unit: written behind it.
            digits: decimals; four significant digits when None.
        """
        value = self.get(path)
        if value is None:
            return node("span", "\N{EN DASH}", class_="none")
        attributes = {"data_digits": "" if digits is None else str(digits), "data_unit": unit}
        return node(
            "data", written(value, unit, digits), value=repr(value), data_path=path, **attributes
        )


def written(value: float, unit: str = "", digits: int | None = None) -> str:
    """A number as text: thousands separated, ``unit`` behind it.

    Args:
        value: the number; a whole number keeps all its digits.
        unit: written behind it; signs stand close.
        digits: decimals; four significant digits when None.
    """
    if isinstance(value, int):
        text = f"{value:,d}"
    elif digits is not None:
        text = f"{value:,.{digits}f}"
        if float(text.replace(",", "")) == 0.0:
            text = "0"
    elif 1e3 <= abs(value) < 1e9:
        text = f"{value:,.0f}"
    else:
        text = f"{value:.4g}"
    if text.startswith("-"):
        text = "\N{MINUS SIGN}" + text[1:]
    if not unit:
        return text
    return f"{text}{'' if unit in _CLOSE_UNITS else chr(0xA0)}{unit}"
