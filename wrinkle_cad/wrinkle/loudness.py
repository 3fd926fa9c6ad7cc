"""How loudly findings are said: a warning in a script, nothing where they stand in a result."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from wrinkle_cad.errors import Finding, WrinkleWarning

_ARE_REPORTED: ContextVar[bool] = ContextVar("findings stand in a result", default=False)


@contextmanager
def findings_in_the_result() -> Iterator[None]:
    """While this runs, no warnings are issued: the findings stand in a result."""
    token = _ARE_REPORTED.set(True)
    try:
        yield
    finally:
        _ARE_REPORTED.reset(token)


def warn_of(findings: tuple[Finding, ...], calls: int) -> bool:
    """Issues one warning for all findings and tells whether there was anything to say.

    Args:
        findings: of one strip.
        calls: so many calls lie between the line to blame and this one.
    """
    if findings and not _ARE_REPORTED.get():
        text = " ".join(finding.message for finding in findings)
        warnings.warn(text, WrinkleWarning, stacklevel=calls + 1)
    return bool(findings)
