"""The house rules of the package, read off its source with the standard ``ast``."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "wrinkle_cad"
MODULES = sorted(PACKAGE.rglob("*.py"))

LAYER = {
    "errors": 0,
    "settings": 0,
    "findings": 0,
    "files": 0.5,
    "strip": 1,
    "pattern": 2,
    "cad": 3,
    "report": 4,
    "wrinkle": 6,
    "job": 7,
    "batch": 12,
    "doctor": 12,
    "cli": 15,
    "__main__": 16,
}
CAD_PACKAGES = {"OCP", "build123d", "cadquery"}
STRIP_PACKAGES = {"numpy", "numba", "wrinkle_cad"}


def module_name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_of(path: Path) -> Iterator[tuple[int, str]]:
    """Every imported module, relative ones made absolute, wherever the import stands."""
    package = module_name(path).split(".")
    if path.name != "__init__.py":
        package = package[:-1]
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                candidate = PACKAGE.parent.joinpath(*stem.split("."), alias.name)
                is_module = candidate.with_suffix(".py").is_file() or candidate.is_dir()
                yield node.lineno, f"{stem}.{alias.name}" if is_module else stem


def layer_of(module: str) -> int:
    return LAYER[module.split(".")[1]]


@pytest.mark.parametrize("path", MODULES, ids=module_name)
def test_imports_point_down(path: Path) -> None:
    if path == PACKAGE / "__init__.py":
        return
    here = module_name(path)
    for line, module in imports_of(path):
        if module.split(".")[0] != "wrinkle_cad":
            continue
        assert module != "wrinkle_cad", f"{path}:{line} imports the package root"
        same_folder = module.split(".")[1] == here.split(".")[1]
        assert same_folder or layer_of(module) < layer_of(here), f"{path}:{line} imports {module}"


@pytest.mark.parametrize("path", MODULES, ids=module_name)
def test_only_the_cad_folder_imports_a_cad_package(path: Path) -> None:
    if path.is_relative_to(PACKAGE / "cad"):
        return
    for line, module in imports_of(path):
        assert module.split(".")[0] not in CAD_PACKAGES, f"{path}:{line} imports {module}"


@pytest.mark.parametrize("path", sorted((PACKAGE / "strip").rglob("*.py")), ids=module_name)
def test_the_strip_folder_knows_arrays_only(path: Path) -> None:
    for line, module in imports_of(path):
        root = module.split(".")[0]
        assert root in STRIP_PACKAGES or root in sys.stdlib_module_names, f"{path}:{line} {module}"


def test_no_module_imports_itself_through_others() -> None:
    graph = {
        module_name(path): {
            module
            for _, module in imports_of(path)
            if module.startswith("wrinkle_cad.") and module != module_name(path)
        }
        for path in MODULES
    }
    order = list(TopologicalSorter(graph).static_order())
    assert len(order) >= len(MODULES)


def test_importing_the_package_loads_no_cad_kernel() -> None:
    code = (
        "import sys, wrinkle_cad, wrinkle_cad.cli\n"
        "heavy = {'OCP', 'build123d', 'numba', 'ezdxf', 'shapely', 'matplotlib'}\n"
        "heavy &= set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_every_public_name_can_be_had() -> None:
    import wrinkle_cad

    for name in wrinkle_cad.__all__:
        assert getattr(wrinkle_cad, name) is not None
