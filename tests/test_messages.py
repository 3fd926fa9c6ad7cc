"""Error messages are sentences: a dash is also a minus and a range."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from wrinkle_cad.errors import CadError, ExportError

PACKAGE = Path(__file__).parent.parent / "wrinkle_cad"
FOLDERS = ("cad/kernel", "cad/exchange", "cad/upper")


def texts_of(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and text of every string that a raised or returned call is given."""
    for node in ast.walk(tree):
        call = node.exc if isinstance(node, ast.Raise) else getattr(node, "value", None)
        if isinstance(node, ast.Raise | ast.Return) and isinstance(call, ast.Call):
            for inner in ast.walk(call):
                if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
                    yield inner.lineno, inner.value


@pytest.mark.parametrize("folder", FOLDERS)
def test_no_message_is_a_row_of_dashes(folder: str) -> None:
    faults = [
        f"{path}:{line} {text!r}"
        for path in sorted((PACKAGE / folder).rglob("*.py"))
        for line, text in texts_of(ast.parse(path.read_text(encoding="utf-8")))
        if " - " in text or text.startswith("- ") or text.endswith(" -")
    ]
    assert not faults, "\n".join(faults)


def test_a_message_of_dashes_would_be_found() -> None:
    tree = ast.parse('def f(x):\n    raise InputError(f"rail {x} - too short - draw it longer")')
    assert any(" - " in text for _, text in texts_of(tree))


def test_what_could_not_be_done_opens_the_sentence() -> None:
    assert str(CadError("sew", "two faces became one.")) == "Cannot sew: two faces became one."
    error = ExportError(Path("out", "a.step"), "STEP", "the disk is full.")
    assert str(error) == "Cannot write STEP a.step: the disk is full."
