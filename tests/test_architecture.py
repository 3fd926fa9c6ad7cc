"""The house rules of the package, read off its source with the standard ``ast``."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path
from statistics import median

PACKAGE = Path(__file__).parent.parent / "wrinkle_cad"
MODULES = sorted(PACKAGE.rglob("*.py"))

LAYER = {
    "errors": 0,
    "settings": 0,
    "files": 1,
    "options": 1,
    "strip": 2,
    "pattern": 3,
    "cad": 4,
    "wrinkle": 5,
    "report": 6,
    "job": 7,
    "batch": 8,
    "doctor": 8,
    "cli": 9,
    "__main__": 10,
}
"""A module imports only from lower layers and from its own folder."""

ROOT_MODULES = {"__init__", "__main__", "errors", "settings", "doctor"}
UPWARD_WHEN_CALLED = {("wrinkle", "report")}
"""A strip offers the figures and the page of the layer above, and imports them when asked."""

CAD_PACKAGES = {"OCP", "build123d", "cadquery"}
PACKAGES_OF = {
    "strip": {"numpy", "numba", "scipy", "shapely"},
    "pattern": {"numpy", "numba", "scipy", "shapely", "ezdxf"},
}
"""What two folders that are of use without CAD may import, beside the standard library."""
IMPORTED_WHEN_CALLED = {"pattern": {"matplotlib", "spyrrow"}}
"""A PDF is drawn with matplotlib, sheets are nested with spyrrow; all else does without."""

LONGEST_MODULE = 400
TYPICAL_MODULE = 150


def module_name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def folder_of(module: str) -> str:
    return module.split(".")[1]


def imports_of(path: Path) -> Iterator[tuple[int, str, bool]]:
    """Line, absolute name, and whether it runs only when a function is called or types checked."""
    package = module_name(path).split(".")
    if path.name != "__init__.py":
        package = package[:-1]
    tree = ast.parse(path.read_text(encoding="utf-8"))
    late = {
        id(inner)
        for outer in ast.walk(tree)
        if isinstance(outer, ast.FunctionDef)
        or (isinstance(outer, ast.If) and ast.unparse(outer.test) == "TYPE_CHECKING")
        for inner in ast.walk(outer)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name, id(node) in late) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else []
            stem = ".".join([*base, *([node.module] if node.module else [])])
            for alias in node.names:
                candidate = PACKAGE.parent.joinpath(*stem.split("."), alias.name)
                is_module = candidate.with_suffix(".py").is_file() or candidate.is_dir()
                name = f"{stem}.{alias.name}" if is_module else stem
                yield node.lineno, name, id(node) in late


def own_imports(path: Path) -> Iterator[tuple[int, str, bool]]:
    return (found for found in imports_of(path) if found[1].split(".")[0] == "wrinkle_cad")


def test_beside_the_folders_stand_five_modules() -> None:
    assert {path.stem for path in PACKAGE.glob("*.py")} == ROOT_MODULES
    folders = {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").is_file()}
    assert folders | ROOT_MODULES == {*LAYER, "__init__"}


def test_the_readme_has_every_folder_on_its_layer() -> None:
    readme = (PACKAGE.parent / "README.md").read_text(encoding="utf-8")
    table = readme.split("## How the code is laid out")[1].split("\n\n")[1]
    rows = [[cell.strip() for cell in row.strip("|").split("|")] for row in table.splitlines()[2:]]
    layers = {}
    named = set()
    for names, _, layer in rows:
        first, *others = [name.strip("`").removesuffix(".py") for name in names.split(", ")]
        here = first.split("/")[0]
        for name in (first, *others):
            layers[name.split("/")[0] if name.strip("/") in LAYER else here] = int(layer)
            named |= {name.strip("/"), f"{here}/{name.strip('/')}"}
    assert layers == {name: layer for name, layer in LAYER.items() if name != "__main__"}
    rooms = {path.relative_to(PACKAGE).parent for path in PACKAGE.glob("*/*/__init__.py")}
    assert {room.as_posix() for room in rooms} <= named


def test_imports_point_down() -> None:
    faults = []
    for path in MODULES:
        if path == PACKAGE / "__init__.py":
            continue
        here = folder_of(module_name(path))
        for line, module, is_late in own_imports(path):
            if module == "wrinkle_cad":
                faults.append(f"{path}:{line} imports the package root")
                continue
            there = folder_of(module)
            is_down = there == here or LAYER[there] < LAYER[here]
            if not is_down and not (is_late and (here, there) in UPWARD_WHEN_CALLED):
                faults.append(f"{path}:{line} imports {module}")
    assert not faults, "\n".join(faults)


def test_no_module_imports_itself_through_others() -> None:
    graph = {
        module_name(path): {
            module
            for _, module, is_late in own_imports(path)
            if not (
                is_late and (folder_of(module_name(path)), folder_of(module)) in UPWARD_WHEN_CALLED
            )
            and module != module_name(path)
        }
        for path in MODULES
        if path != PACKAGE / "__init__.py"
    }
    assert len(list(TopologicalSorter(graph).static_order())) >= len(graph)


def test_only_the_cad_folder_imports_a_cad_package() -> None:
    faults = [
        f"{path}:{line} imports {module}"
        for path in MODULES
        if not path.is_relative_to(PACKAGE / "cad") and path != PACKAGE / "__init__.py"
        for line, module, _ in imports_of(path)
        if module.split(".")[0] in CAD_PACKAGES
        and not (path.is_relative_to(PACKAGE / "wrinkle") and line in lines_for_type_checkers(path))
    ]
    assert not faults, "\n".join(faults)


def lines_for_type_checkers(path: Path) -> set[int]:
    """Lines that never run: what a script holds says which shapes of build123d it gives."""
    return {
        line
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for line in range(node.lineno, node.end_lineno + 1)
    }


def test_examples_use_public_names_only() -> None:
    faults = [
        f"{path}: {node.module}"
        for path in sorted((PACKAGE.parent / "shoe_examples").rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("wrinkle_cad.")
    ]
    assert not faults, "\n".join(faults)


def test_only_one_module_knows_what_two_versions_of_the_cad_kernel_call_differently() -> None:
    versions = PACKAGE / "cad" / "kernel" / "versions.py"
    faults = [
        f"{path}:{node.lineno}"
        for path in MODULES
        if path != versions
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Try)
        and any(isinstance(inner, ast.ImportFrom) for inner in node.body)
        and "OCP" in ast.unparse(node)
    ]
    faults += [
        f"{path}:{line} imports {module}"
        for path in MODULES
        if path != versions
        for line, module, _ in imports_of(path)
        if module in {"OCP.collections", "OCP.TopTools", "OCP.TColgp", "OCP.TColStd"}
    ]
    assert not faults, "\n".join(faults)


def test_strip_and_pattern_are_of_use_without_cad_and_terminal() -> None:
    faults = [
        f"{path}:{line} imports {module}"
        for folder, packages in PACKAGES_OF.items()
        for path in sorted((PACKAGE / folder).rglob("*.py"))
        for line, module, is_late in imports_of(path)
        if module.split(".")[0] not in packages | {"wrinkle_cad"} | sys.stdlib_module_names
        and not (is_late and module.split(".")[0] in IMPORTED_WHEN_CALLED.get(folder, ()))
    ]
    assert not faults, "\n".join(faults)


def test_modules_have_a_size_that_one_purpose_needs() -> None:
    lines = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in MODULES}
    assert [path for path, count in lines.items() if count > LONGEST_MODULE] == []
    sizes = [count for path, count in lines.items() if path.name != "__init__.py"]
    assert median(sizes) <= TYPICAL_MODULE


def test_only_the_command_line_workers_and_dates_of_exports_look_at_the_environment() -> None:
    looking = {
        path.relative_to(PACKAGE).as_posix()
        for path in MODULES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr in ("environ", "getenv")
    }
    assert looking == {"cli/main.py", "batch/workers/worker.py", "wrinkle/cut_pattern.py"}


def test_the_package_and_its_help_load_nothing_heavy() -> None:
    code = (
        "import sys, wrinkle_cad, wrinkle_cad.cli.main as cli\n"
        "try: cli.main(['run', '--help'])\n"
        "except SystemExit: pass\n"
        "heavy = {'OCP', 'build123d', 'numpy', 'scipy', 'numba', 'ezdxf', 'shapely', 'rich'}\n"
        "heavy &= set(sys.modules)\n"
        "assert not heavy, heavy"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_every_public_name_can_be_had() -> None:
    import wrinkle_cad

    for name in wrinkle_cad.__all__:
        assert getattr(wrinkle_cad, name) is not None


def test_each_clause_that_catches_everything_says_why() -> None:
    bare = []
    for path in sorted(PACKAGE.rglob("*.py")):
        lines = path.read_text().splitlines()
        for number, line in enumerate(lines):
            if re.match(r"\s*except( Exception| BaseException|:)", line):
                around = (lines[number - 1], lines[number + 1])
                if not any(each.strip().startswith("#") for each in around):
                    bare.append(f"{path.name}:{number + 1}")
    assert not bare
