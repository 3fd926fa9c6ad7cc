"""Settings that check themselves, each value by the kind and the range that its field states."""

from __future__ import annotations

import math
import numbers
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Final

from wrinkle_cad.errors import InputError

from .option import Kind, Option, OptionField, options_of

_SHOWN: Final = 60
_DIGITS_SHOWN: Final = 20


def check_options(
    settings: object, error: type[InputError] = InputError, *, what: str = ""
) -> None:
    """Checks every option of a frozen dataclass and puts the plain value in its place.

    Whole numbers become floats where floats are wanted, sequences tuples, one number all of them
    where it may stand for all, the word "none" None where that is a value.

    Args:
        settings: the dataclass, called from its ``__post_init__``.
        error: the class that is raised.
        what: begins the message where an option's name alone would say too little.

    Raises:
        InputError: a value is of the wrong kind or out of its range; one sentence names it.

    Example:
        >>> from wrinkle_cad.pattern.piece.options import PieceSettings
        >>> PieceSettings(quantity=0)
        Traceback (most recent call last):
        wrinkle_cad.errors.InputError: quantity cannot be 0: give a whole number from 1 to 1000000.
    """
    for field in options_of(type(settings)).values():
        value = checked_option(field, getattr(settings, field.name), error, what=what)
        object.__setattr__(settings, field.name, value)


def checked_option(
    field: OptionField, value: Any, error: type[InputError] = InputError, *, what: str = ""
) -> Any:
    """Returns the plain value of one option; see ``check_options``.

    Raises:
        InputError: it is of the wrong kind or out of its range.
    """
    if value is None and field.kind.allows_none:
        return None
    if field.takes_none_as_text and value == "none":
        return None
    try:
        return _plain(field.kind, field.option, value)
    except _UnfitError:
        unit = f" {field.option.unit}" if field.option.unit and _is_number(value) else ""
        found = f"{_shown(value)}{unit}"
        raise error(f"{what}{field.name} cannot be {found}: give {field.allowed}.") from None


def check_known(
    given: Iterable[str], known: Iterable[str], source: str, error: type[InputError] = InputError
) -> None:
    """Raises an ``InputError`` that names the first of the given options that is not known.

    Args:
        given: names of options.
        known: names of all there are.
        source: where they are given: ``job.toml``, ``pattern()``.
        error: the class that is raised.
    """
    names = sorted(known)
    for name in given:
        if name not in names:
            near = get_close_matches(str(name), names, n=3)
            # A unit that was left out is nearer than another word of like letters.
            near = [each for each in near if each.startswith(f"{name}_")] or near
            advice = f"did you mean {' or '.join(near)}?" if near else f"give {', '.join(names)}."
            raise error(f"{source} has no option {_shown(name)}: {advice}")


def check_numbers(**named: object) -> None:
    """Raises an ``InputError`` that names the first argument that is no number.

    Args:
        named: arguments by their names; a tuple or list holds one number for each rail, and what
            can be called is no number's business.

    Example:
        >>> check_numbers(waves="3")
        Traceback (most recent call last):
        wrinkle_cad.errors.InputError: waves cannot be '3': give a number.
    """
    for name, value in named.items():
        if callable(value):
            continue
        parts = value if isinstance(value, tuple | list) else (value,)
        if not parts or not all(_is_number(part) or callable(part) for part in parts):
            raise InputError(f"{name} cannot be {_shown(value)}: give a number.")


class _UnfitError(Exception):
    """A value that an option cannot have."""


def _plain(kind: Kind, option: Option, value: Any) -> Any:
    if isinstance(value, str) and value in kind.choices:
        return value
    if kind.base is tuple:
        return _tuple(kind, option, value)
    if kind.base in (float, int):
        return _number(kind.base, option, value)
    if kind.base is Path and isinstance(value, str | Path) and "\0" not in str(value):
        return Path(value)
    if kind.base in (bool, str) and isinstance(value, kind.base):
        return value
    raise _UnfitError


def _tuple(kind: Kind, option: Option, value: Any) -> tuple[Any, ...]:
    assert kind.part is not None
    if option.is_one_for_all and kind.count is not None and _is_number(value):
        value = (value,)
    if isinstance(value, str | bytes | Mapping | set) or not isinstance(value, Iterable):
        raise _UnfitError
    parts = tuple(_plain(kind.part, option, part) for part in value)
    if option.is_one_for_all and kind.count is not None and len(parts) == 1:
        parts *= kind.count
    if kind.count not in (None, len(parts)):
        raise _UnfitError
    return parts


def _number(base: type, option: Option, value: Any) -> float | int:
    if not _is_number(value) or (base is int and not isinstance(value, numbers.Integral)):
        raise _UnfitError
    try:
        number = base(value)
        is_finite = math.isfinite(number)
    except OverflowError:
        raise _UnfitError from None
    opens_low, opens_high = option.is_open
    is_low = number <= option.least if opens_low else number < option.least
    is_high = number >= option.most if opens_high else number > option.most
    if not is_finite or is_low or is_high:
        raise _UnfitError
    return number  # type: ignore[no-any-return]


def _is_number(value: object) -> bool:
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def _shown(value: object) -> str:
    """A value as it stands in a message: one line, never long."""
    if isinstance(value, numbers.Real) and not isinstance(value, bool | str):
        if not isinstance(value, numbers.Integral):
            return f"{float(value):.12g}"
        # Python refuses to write very long whole numbers; their length is what matters.
        digits = int(int(value).bit_length() * math.log10(2.0)) + 1
        return str(int(value)) if digits <= _DIGITS_SHOWN else f"a number of {digits} digits"
    if isinstance(value, tuple | list):
        said = f"({', '.join(_shown(part) for part in value[:_SHOWN])})"
    else:
        said = " ".join(repr(value).split())
    return said if len(said) <= _SHOWN else f"{said[: _SHOWN - 3]}..."
