"""The flags that one job and a batch of jobs share; light, since every command line loads it.

They are made from the fields of the settings that ``Job`` joins; none is written here.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from wrinkle_cad.errors import InputError
from wrinkle_cad.job.job import Job
from wrinkle_cad.options.option import OptionField, options_of
from wrinkle_cad.options.text import is_repeatable, metavar_of, value_of_text


def add_job_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the flags of a job, in the groups of its settings."""
    parser.add_argument(
        "-o", "--output-dir", type=Path, metavar="DIR", help="folder for the outputs (out)"
    )
    for settings_class in Job.__bases__:
        add_option_arguments(parser, settings_class)


def add_option_arguments(parser: argparse.ArgumentParser, settings_class: type[Any]) -> None:
    """Adds the flags of one settings class as a group with the class's title.

    Args:
        parser: receives the flags.
        settings_class: a dataclass with options and a ``title``.
    """
    add = parser.add_argument_group(settings_class.title).add_argument
    for field in options_of(settings_class).values():
        if field.flag is not None:
            _add_flag(add, field)


def add_job_argument(parser: argparse.ArgumentParser, name: str) -> None:
    """Adds the flag of one setting of a job; it is None where the flag was not given.

    Args:
        parser: receives the flag.
        name: of the setting.
    """
    _add_flag(parser.add_argument, options_of(Job)[name])


def job_keywords(given: argparse.Namespace, environment: Mapping[str, str]) -> dict[str, Any]:
    """The settings of a job among the arguments given; None where a flag was not given.

    Args:
        given: the parsed arguments.
        environment: the environment variables; SOURCE_DATE_EPOCH is taken from them.

    Raises:
        InputError: SOURCE_DATE_EPOCH is not a whole number.
    """
    names = set(options_of(Job)) - {"input", "source_date_epoch"}
    keywords = {name: value for name, value in vars(given).items() if name in names}
    return {**keywords, "source_date_epoch": _epoch(environment.get("SOURCE_DATE_EPOCH", ""))}


def _add_flag(add: Callable[..., Any], field: OptionField) -> None:
    assert field.flag is not None
    # The default is None, not the option's own: a job file may say something else.
    told = {"dest": field.name, "default": None, "help": field.description.replace("%", "%%")}
    if field.kind.base is bool:
        action = argparse.BooleanOptionalAction if field.default else "store_true"
        add(field.flag, action=action, **told)
        return
    choices = None
    if field.kind.base is None:
        choices = [*field.kind.choices, *(["none"] if field.takes_none_as_text else [])]
    add(
        field.flag,
        type=partial(_value, field),
        choices=choices,
        metavar=None if choices else metavar_of(field),
        action="append" if is_repeatable(field) else "store",
        **told,
    )


def _value(field: OptionField, text: str) -> Any:
    try:
        return value_of_text(field, text)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _epoch(text: str) -> int | None:
    if text == "":
        return None
    if not text.isdecimal() or len(text) > 20:
        raise InputError(
            f"SOURCE_DATE_EPOCH is {text[:40]!r} and must be whole seconds since 1970: correct it."
        )
    return int(text)
