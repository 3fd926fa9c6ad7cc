"""Every public function and class is documented with an example that runs."""

from __future__ import annotations

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
