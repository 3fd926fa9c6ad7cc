"""Functions that take a settings class's options as keywords: typed, listed, documented."""

from __future__ import annotations

import functools
import inspect
import textwrap
from collections.abc import Callable
from typing import Any, Concatenate, ParamSpec, TypeVar

from .checking import check_known
from .option import options_of

Parameters = ParamSpec("Parameters")
Result = TypeVar("Result")
Owner = TypeVar("Owner")


def takes_options_of(
    arguments_class: Callable[Parameters, object],
) -> Callable[
    [Callable[Concatenate[Owner, ...], Result]],
    Callable[Concatenate[Owner, Parameters], Result],
]:
    """Returns a decorator that gives a method the parameters of a dataclass.

    Type checkers, editors and ``help()`` then see each option of the class with its type and its
    default, though the method itself passes them on as ``**options``; the options are listed in
    its docstring as well.

    Args:
        arguments_class: a dataclass whose fields are the method's parameters after ``self``.

    Example:
        >>> import inspect
        >>> from wrinkle_cad import WrinkleStrip
        >>> list(inspect.signature(WrinkleStrip).parameters)[:4]
        ['p', 'q', 'tolerance', 'max_chord']
    """

    def decorate(
        method: Callable[Concatenate[Owner, ...], Result],
    ) -> Callable[Concatenate[Owner, Parameters], Result]:
        described: Any = method
        own = inspect.signature(method)
        listed = list(inspect.signature(arguments_class).parameters.values())
        itself = next(iter(own.parameters.values()))
        described.__signature__ = own.replace(parameters=[itself, *listed])
        described.__doc__ = f"{inspect.getdoc(method)}\n\nOptions:\n{_list(arguments_class)}"
        return described  # type: ignore[no-any-return]

    return decorate


def knows_its_options(
    function: Callable[Parameters, Result], name: str = ""
) -> Callable[Parameters, Result]:
    """Returns a function that refuses unknown keywords with the nearest ones that it knows.

    Args:
        function: what is called.
        name: what messages call it; its own name when empty.

    Raises:
        InputError: when called, a keyword is not known.

    Example:
        >>> from wrinkle_cad import carve
        >>> carve(None, None, None, margn=2)
        Traceback (most recent call last):
        wrinkle_cad.errors.InputError: carve() has no option 'margn': did you mean margin?
    """
    known = list(inspect.signature(function).parameters)

    @functools.wraps(function)
    def checked(*args: Parameters.args, **kwargs: Parameters.kwargs) -> Result:
        check_known(kwargs, known, f"{name or function.__name__}()")
        return function(*args, **kwargs)

    return checked


def _list(arguments_class: Any) -> str:
    lines = []
    for field in options_of(arguments_class).values():
        text = f"{field.name}: {field.description}; {field.allowed}."
        lines += textwrap.wrap(text, 96, initial_indent="    ", subsequent_indent="        ")
    return "\n".join(lines)
