"""Options written as text: values of flags, and what stands for them in ``--help``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from wrinkle_cad.errors import InputError

from .checking import checked_option
from .option import Kind, Option, OptionField

_NAMES = {float: "X", int: "N", str: "TEXT", Path: "FILE"}


def value_of_text(field: OptionField, text: str) -> Any:
    """Returns the value of an option that a text stands for; parts are divided by commas.

    Of an option that is a list of lists (holes), the text is one of its parts.

    Raises:
        InputError: the text stands for no value of this kind; its range is not looked at.

    Example:
        >>> from wrinkle_cad.cad.upper.options import WaveSettings
        >>> from wrinkle_cad.options.option import options_of
        >>> value_of_text(options_of(WaveSettings)["height"], "2,3.5")
        (2.0, 3.5)
    """
    if text == "none" and field.takes_none_as_text:
        return text
    kind = field.kind
    if is_repeatable(field):
        assert kind.part is not None
        kind = kind.part
    try:
        return _value(kind, text)
    except (ValueError, OverflowError):
        # Of a text the kind is refused in the same words as of a value.
        checked_option(field, text)
        raise InputError(f"{field.name} cannot be {text!r}: give {field.allowed}.") from None


def is_repeatable(field: OptionField) -> bool:
    """Whether the flag may be given several times, once for each of the option's parts."""
    return field.kind.part is not None and field.kind.part.base is tuple


def metavar_of(field: OptionField) -> str:
    """What stands for the value in ``--help``."""
    return field.option.metavar or _metavar(field.kind, field.option)


def _metavar(kind: Kind, option: Option) -> str:
    if kind.part is None:
        words = [*kind.choices, *([_NAMES[kind.base]] if kind.base in _NAMES else [])]
        if option.unit and kind.base in (float, int):
            words[-1] = option.unit.upper()
        return "|".join(words)
    part = _metavar(kind.part, option)
    if option.is_one_for_all and kind.count == 2:
        return f"{part}[,{part}]"
    return ",".join([part] * (kind.count or 2))


def _value(kind: Kind, text: str) -> Any:
    if text in kind.choices or kind.base is None:
        return text
    if kind.part is not None:
        # 1200x600 is how sheets are spoken of.
        listed = text.replace("x", ",") if kind.part.base is float else text
        return tuple(_value(kind.part, part.strip()) for part in listed.split(",") if part.strip())
    return kind.base(text)
