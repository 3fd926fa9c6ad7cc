"""What a step noticed without stopping: it goes into the result, not to the screen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Severity = Literal["info", "warning", "error"]


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that the user should know."""

    code: str
    """Short kebab-case key, stable between versions ("rails-turned-alike")."""
    severity: Severity
    """``info``, ``warning`` or ``error``."""
    message: str
    """One line: what - what was found, with its unit - the limit - what to do."""
