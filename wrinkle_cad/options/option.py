"""What a field of a settings class states about its option: help, unit, range, flag."""

from __future__ import annotations

import math
import types
import typing
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields
from functools import cache
from pathlib import Path
from typing import Any, Final, Literal

_KEY: Final = "wrinkle_cad.option"


@dataclass(frozen=True, slots=True, kw_only=True)
class Option:
    """What a field's metadata says; its name, type and default are the field's own."""

    help: str
    """What it is, in a few words, without the default."""
    unit: str
    """Of its numbers, as it stands behind them: ``mm``, ``deg``, ``percent``; empty without one."""
    least: float
    """Its smallest value."""
    most: float
    """Its largest value."""
    is_open: tuple[bool, bool]
    """Whether ``least`` and ``most`` themselves are out of the range."""
    is_one_for_all: bool
    """Whether one number may stand for all of its numbers."""
    may_be_file: bool
    """Whether a text that ends in ``.toml`` is the path of a file."""
    when_none: str
    """What None means, in a word or two."""
    metavar: str
    """Stands for the value in ``--help``; derived from type and unit when empty."""
    flag: str | None
    """Its flag; None when the command line has none."""


def option(
    text: str,
    *,
    unit: str = "",
    least: float | None = None,
    most: float | None = None,
    above: float | None = None,
    below: float | None = None,
    is_one_for_all: bool = False,
    may_be_file: bool = False,
    when_none: str = "",
    metavar: str = "",
    flag: str | None = "",
) -> Mapping[str, Any]:
    """Returns the metadata that make a dataclass field an option.

    Args:
        text: what it is, in a few words, without the default.
        unit: of its numbers.
        least: its smallest value.
        most: its largest value.
        above: it must be larger than this.
        below: it must be smaller than this.
        is_one_for_all: one number may stand for all of its numbers.
        may_be_file: a text that ends in ``.toml`` is the path of a file.
        when_none: what None means, in a word or two.
        metavar: stands for the value in ``--help``; derived when empty.
        flag: its flag; made from the field's name when empty, none at all when None.

    Example:
        >>> from dataclasses import dataclass, field
        >>> @dataclass(frozen=True, kw_only=True)
        ... class Washer:
        ...     bore: float = field(default=6.4, metadata=option("hole", unit="mm", above=0.0))
        >>> options_of(Washer)["bore"].allowed
        'a number above 0 mm'
    """
    lower = above if above is not None else least
    upper = below if below is not None else most
    stated = Option(
        help=text,
        unit=unit,
        least=-math.inf if lower is None else lower,
        most=math.inf if upper is None else upper,
        is_open=(above is not None, below is not None),
        is_one_for_all=is_one_for_all,
        may_be_file=may_be_file,
        when_none=when_none,
        metavar=metavar,
        flag=flag,
    )
    return {_KEY: stated}


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """What values an annotation allows."""

    base: type | None
    """``float``, ``int``, ``bool``, ``str``, ``Path``, ``tuple``, or None for choices alone."""
    choices: tuple[str, ...] = ()
    """Words of a ``Literal``."""
    allows_none: bool = False
    """Whether None is a value."""
    part: Kind | None = None
    """Of each part of a tuple."""
    count: int | None = None
    """Parts of a tuple; any number of them when None."""

    def in_words(self, option: Option) -> str:
        """What is allowed, to stand behind "give"."""
        said = list(self.choices)
        if self.part is not None:
            said.append(self._parts_in_words(option))
        elif self.base in (float, int):
            number = "a number" if self.base is float else "a whole number"
            said.append(number + _range_in_words(option))
        elif self.base is not None:
            said.append({bool: "true or false", str: "a text", Path: "a path"}[self.base])
        return _joined(said)

    def _parts_in_words(self, option: Option) -> str:
        assert self.part is not None
        if self.part.base is tuple:
            return f"a list of {self.part._parts_in_words(option)}"
        amount = "a list of " if self.count is None else f"{self.count} "
        if self.part.choices:
            return f"{amount}{_joined(list(self.part.choices))}"
        word = "numbers" if self.part.base in (float, int) else "texts"
        one = ", or one for all" if option.is_one_for_all else ""
        return f"{amount}{word}{_range_in_words(option)}{one}"


@dataclass(frozen=True, slots=True, kw_only=True)
class OptionField:
    """One option of a settings class."""

    name: str
    """Of the field: the keyword and the TOML key."""
    kind: Kind
    """What its values are."""
    option: Option
    """What its metadata says."""
    default: Any
    """What it is when it is not given."""

    @property
    def flag(self) -> str | None:
        """Its flag with the dashes; None when the command line has none."""
        flag = self.option.flag
        return f"--{self.name.replace('_', '-')}" if flag == "" else flag

    def is_path(self, value: object) -> bool:
        """Whether a value is the path of a file."""
        is_toml = isinstance(value, str) and value.lower().endswith(".toml")
        return self.kind.base is Path or (self.option.may_be_file and is_toml)

    @property
    def allowed(self) -> str:
        """What is allowed, to stand behind "give"."""
        none = ", or none" if self.takes_none_as_text else ""
        return self.kind.in_words(self.option) + none

    @property
    def takes_none_as_text(self) -> bool:
        """Whether the word "none" means None: where None is not what one gets anyway."""
        return self.kind.allows_none and self.default is not None

    @property
    def default_in_words(self) -> str:
        """The default as a user would write it; empty when there is nothing to say."""
        if self.default is None:
            return self.option.when_none
        if isinstance(self.default, tuple):
            parts = dict.fromkeys(_written(part) for part in self.default)
            is_one = self.option.is_one_for_all and len(parts) == 1
            return next(iter(parts)) if is_one else ",".join(map(_written, self.default))
        return "" if isinstance(self.default, bool) else _written(self.default)

    @property
    def description(self) -> str:
        """Its help with the unit and the default."""
        unit = f", in {self.option.unit}" if self.option.unit else ""
        default = f" ({self.default_in_words})" if self.default_in_words else ""
        return f"{self.option.help}{unit}{default}"


def options_of(settings_class: type) -> Mapping[str, OptionField]:
    """Returns the options of a settings class by name, in the order of its fields.

    Args:
        settings_class: a dataclass; fields without ``option(...)`` are left out.

    Raises:
        TypeError: an annotation is of no kind that an option can have.

    Example:
        >>> from wrinkle_cad.pattern.piece.options import PieceSettings
        >>> options_of(PieceSettings)["hand"].allowed
        'left or right'
    """
    key: Any = settings_class
    return _options_of(key)


def values_of(settings: object, settings_class: type) -> dict[str, Any]:
    """Returns those settings that are options of a class, by name.

    Args:
        settings: has at least the options of the class as attributes.
        settings_class: a settings class.
    """
    return {name: getattr(settings, name) for name in options_of(settings_class)}


@cache
def _options_of(settings_class: Any) -> Mapping[str, OptionField]:
    hints = typing.get_type_hints(settings_class)
    found = {}
    for field in fields(settings_class):
        if _KEY not in field.metadata:
            continue
        default = field.default if field.default is not MISSING else None
        found[field.name] = OptionField(
            name=field.name,
            kind=_kind_of(hints[field.name]),
            option=field.metadata[_KEY],
            default=default,
        )
    return types.MappingProxyType(found)


def _kind_of(hint: Any) -> Kind:
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin is Literal:
        return Kind(base=None, choices=arguments)
    if origin in (typing.Union, types.UnionType):
        kinds = [_kind_of(part) for part in arguments if part is not types.NoneType]
        others = [kind for kind in kinds if kind.base is not None]
        if len(others) > 1:
            raise TypeError(f"an option cannot be {hint}")
        last = others[0] if others else Kind(base=None)
        return Kind(
            base=last.base,
            choices=tuple(choice for kind in kinds for choice in kind.choices),
            allows_none=types.NoneType in arguments,
            part=last.part,
            count=last.count,
        )
    if origin is tuple:
        is_open = arguments[-1] is Ellipsis
        count = None if is_open else len(arguments)
        return Kind(base=tuple, part=_kind_of(arguments[0]), count=count)
    if hint in (float, int, bool, str, Path):
        return Kind(base=hint)
    raise TypeError(f"an option cannot be {hint}")


def _range_in_words(option: Option) -> str:
    unit = f" {option.unit}" if option.unit else ""
    has_least, has_most = math.isfinite(option.least), math.isfinite(option.most)
    opens_low, opens_high = option.is_open
    least, most = f"{option.least:.12g}", f"{option.most:.12g}"
    if has_least and has_most and not opens_low and not opens_high:
        return f" from {least} to {most}{unit}"
    words = []
    if has_least:
        words.append(f"{'above' if opens_low else 'of at least'} {least}")
    if has_most:
        words.append(f"{'below' if opens_high else 'at most'} {most}")
    return f" {' and '.join(words)}{unit}" if words else ""


def _joined(words: list[str]) -> str:
    return " or ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def _written(value: Any) -> str:
    return f"{value:.12g}" if isinstance(value, float) else str(value)
