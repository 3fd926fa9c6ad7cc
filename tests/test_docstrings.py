"""Every public function and class is documented with an example that runs."""

from __future__ import annotations

import ast
import doctest
import inspect
from pathlib import Path

import pytest

import wrinkle_cad
import wrinkle_cad.strip


def documented(package: object) -> list[object]:
    names = package.__all__  # type: ignore[attr-defined]
    found = (getattr(package, name) for name in names)
    return [thing for thing in found if inspect.isclass(thing) or inspect.isfunction(thing)]


PUBLIC = documented(wrinkle_cad) + documented(wrinkle_cad.strip)


@pytest.mark.filterwarnings("ignore::wrinkle_cad.WrinkleWarning")
@pytest.mark.parametrize("thing", PUBLIC, ids=lambda thing: thing.__name__)
def test_the_example_of_a_public_name_runs(
    thing: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    name: str = thing.__name__  # type: ignore[attr-defined]
    scope = vars(inspect.getmodule(thing)).copy()
    examples = [
        test
        for test in doctest.DocTestFinder(recurse=False).find(thing, name, globs=scope)
        if test.examples
    ]
    assert examples, f"{name} has no example"
    said: list[str] = []
    for example in examples:
        result = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=said.append)
        assert result.failed == 0, "".join(said)


PACKAGE = Path(wrinkle_cad.__file__).parent


def undocumented_fields(tree: ast.AST) -> list[str]:
    """Fields of public dataclasses with neither a docstring beneath nor the help of an option."""
    faults = []
    for owner in ast.walk(tree):
        if not isinstance(owner, ast.ClassDef) or owner.name.startswith("_"):
            continue
        if not any("dataclass" in ast.unparse(line) for line in owner.decorator_list):
            continue
        if "Attributes:" in (ast.get_docstring(owner) or ""):
            faults.append(f"{owner.name} lists its fields")
        for field, after in zip(owner.body, [*owner.body[1:], None], strict=True):
            if not isinstance(field, ast.AnnAssign) or "ClassVar" in ast.unparse(field.annotation):
                continue
            is_told = isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant)
            if not is_told and "metadata=" not in ast.unparse(field):
                faults.append(f"{owner.name}.{ast.unparse(field.target)}")
    return faults


def test_every_field_of_a_public_record_is_told_beneath_it() -> None:
    faults = [
        f"{path.relative_to(PACKAGE)}: {fault}"
        for path in sorted(PACKAGE.rglob("*.py"))
        for fault in undocumented_fields(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert not faults, "\n".join(faults)


def test_a_field_that_is_not_told_would_be_found() -> None:
    record = '@dataclass\nclass A:\n    """Attributes:"""\n    x: int\n    y: int\n    """Y."""\n'
    assert undocumented_fields(ast.parse(record)) == ["A lists its fields", "A.x"]
