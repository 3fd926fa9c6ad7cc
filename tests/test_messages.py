"""Error messages are sentences: a dash is also a minus and a range."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from wrinkle_cad.errors import CadError, ExportError

PACKAGE = Path(__file__).parent.parent / "wrinkle_cad"
ERRORS = {"CadError", "ExportError", "InputError", "JobError"}
MINUS = re.compile(r"\(\w+ - \w+\)")
"""A difference in parentheses, as the help of an option may have it."""


def texts_of(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and text of every string but docstrings and templates of pages and scripts."""
    quiet = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in ast.walk(tree):
        if not isinstance(node, ast.Constant) or not isinstance(node.value, str):
            continue
        if id(node) not in quiet and "<html" not in node.value:
            yield node.lineno, MINUS.sub("", node.value)


def has_dash(text: str) -> bool:
    return (
        bool(re.search(r"\w - \w", text)) or text.startswith("- ") or text.endswith((" -", " - "))
    )


def raised_texts(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and end of every message that is written out where one of our errors is made."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ERRORS and node.args:
            message = node.args[-1]
            last = message.values[-1] if isinstance(message, ast.JoinedStr) else message
            if isinstance(last, ast.Constant):
                yield node.lineno, str(last.value)


def trees() -> Iterator[tuple[Path, ast.AST]]:
    for path in sorted(PACKAGE.rglob("*.py")):
        yield path, ast.parse(path.read_text(encoding="utf-8"))


def test_no_message_is_a_row_of_dashes() -> None:
    faults = [
        f"{path}:{line} {text!r}"
        for path, tree in trees()
        for line, text in texts_of(tree)
        if has_dash(text)
    ]
    assert not faults, "\n".join(faults)


def test_every_message_ends_as_a_sentence_does() -> None:
    found = [(path, line, text) for path, tree in trees() for line, text in raised_texts(tree)]
    assert len(found) > 150
    faults = [f"{path}:{line} {text!r}" for path, line, text in found if not text.endswith(".")]
    assert not faults, "\n".join(faults)


def test_a_message_of_dashes_would_be_found() -> None:
    tree = ast.parse('def f(x):\n    raise InputError(f"rail {x} - too short - draw it longer")')
    assert any(has_dash(text) for _, text in texts_of(tree))
    assert not any(text.endswith(".") for _, text in raised_texts(tree))
    assert not any(has_dash(text) for _, text in texts_of(ast.parse('help = "p\' x (q - p)"')))


def test_what_could_not_be_done_opens_the_sentence() -> None:
    assert str(CadError("sew", "two faces became one.")) == "Cannot sew: two faces became one."
    error = ExportError(Path("out", "a.step"), "STEP", "the disk is full.")
    assert str(error) == "Cannot write STEP a.step: the disk is full."
