"""Editors and type checkers see the public API: typical use is right, typical slips are errors."""

from __future__ import annotations

import inspect
import json
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import wrinkle_cad
import wrinkle_cad.strip
from wrinkle_cad.options.option import options_of
from wrinkle_cad.pattern.piece.options import PieceSettings
from wrinkle_cad.wrinkle.options import StripSettings

ROOT = Path(__file__).parent.parent

HEAD = """\
from __future__ import annotations
from pathlib import Path
from build123d import Edge, Shell, Sketch, Spline
from wrinkle_cad import (
    Job, JobDone, NotchRule, Pattern, PieceSettings, WrinkleStrip, carve, make_job,
    pattern_of_strips, read_cad, run_job, stitch, wrinkle_profiles,
)
from wrinkle_cad.strip import triangulate, unroll

p_curve, q_curve = Spline((0, 0, 0), (50, 0, 4), (99, 0, 0)), Spline((0, 20, 0), (99, 20, 0))
"""

RIGHT = """\
strip = WrinkleStrip(p_curve, q_curve, tolerance=0.1, surface="facets", criteria=("bending",))
shell: Shell = strip.shell("cones")
pattern: Pattern = strip.pattern(
    PieceSettings(size="42"), seam_allowance=(6, 6, 0, 0), notches_p=NotchRule(count=3)
)
sketch: Sketch = pattern.sketch
print(shell.area, sketch.area, strip.report.area_3d_mm2, pattern.pieces[0].name)
pattern.export_dxf("a.dxf", profile="aama", version="R12")
shapes = {shape.name: shape.shape for shape in read_cad(Path("a.step"), unit="mm").shapes}
opening = carve(shapes["upper"], shapes["P"], shapes["Q"], margin=4)
p, q = wrinkle_profiles(opening, waves=5, height=(2, 3.5), phase_deg=(0, 60), side="both")
edge: Edge = p
stitched = stitch(opening, WrinkleStrip(p=p, q=q))
print(stitched.shell.area, stitched.report.free_edges_after, opening.body.area, opening.p.label)
done = run_job(Job(input=Path("a.step"), waves=(5, 5), height=(3, 3), grain="across"))
if isinstance(done, JobDone):
    print(done.summary["strips"], make_job(Path("b.step"), {"tolerance": 0.2}).tolerance + 1.0)
found = triangulate([[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]], search="local")
print(unroll(found).p.shape, found.bridges.shape, pattern_of_strips([strip]).pieces)
"""

SLIPS = (
    "WrinkleStrip(p_curve, q_curve, tolernce=0.1)",
    "WrinkleStrip(p_curve, q_curve).reprt",
    'WrinkleStrip(p_curve, q_curve, surface="nurbs")',
    'WrinkleStrip(p_curve, q_curve, tolerance="fine")',
    "WrinkleStrip(p_curve)",
    "WrinkleStrip(p_curve, q_curve).pattern(seam_alowance=(6, 6, 6, 6))",
    "WrinkleStrip(p_curve, q_curve).pattern(seam_allowance=(6, 6))",
    'WrinkleStrip(p_curve, q_curve).pattern(hand="both")',
    'WrinkleStrip(p_curve, q_curve).pattern().export_dxf("a.dxf", version="R14")',
    "wrinkle_profiles(carve(1, p_curve, q_curve), waves=5)",
    "stitch(carve(1, p_curve, q_curve), WrinkleStrip(p_curve, q_curve)).report.edges",
    'Job(input=Path("a.step"), unit="furlong")',
    'Job(input=Path("a.step"), wave=5)',
    'run_job(Job(input=Path("a.step"))).outputs',
    'triangulate([[0, 0, 0]], [[0, 0, 0]], search="best")',
    "unroll(triangulate([[0, 0, 0]], [[0, 0, 0]])).overlap",
    "import wrinkle_cad; wrinkle_cad.WrinkelStrip",
)
SLIPS_WITH_BUILD123D = (
    "WrinkleStrip(p_curve, q_curve).shell().aera",
    "WrinkleStrip(p_curve, q_curve).pattern().sketch.wiers()",
    "wrinkle_profiles(carve(1, p_curve, q_curve), waves=5, height=3)[0].lenght",
    "carve(1, p_curve, q_curve).p.lable",
)
"""Mypy takes any attribute of build123d's shapes: their base class, anytree's, is untyped."""


def write(path: Path, lines: str) -> None:
    path.write_text(HEAD + lines, encoding="utf-8")


def faults(checker: str, paths: list[Path]) -> dict[tuple[str, int], str]:
    """Errors by file and by the number of the line after the head, from 0.

    Both look for packages where this Python has its own, whatever the path's first Python is.
    """
    command = {
        "pyright": ["pyright", "--outputjson", "--pythonpath", sys.executable],
        "mypy": ["mypy", "--strict", "--output=json"],
    }[checker]
    done = subprocess.run(
        [sys.executable, "-m", *command, *map(str, paths)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode in (0, 1), done.stderr
    if checker == "pyright":
        said = json.loads(done.stdout)["generalDiagnostics"]
        found = [(e["file"], e["range"]["start"]["line"], e["message"]) for e in said]
    else:
        entries = [json.loads(line) for line in done.stdout.splitlines() if line]
        errors = [entry for entry in entries if entry["severity"] == "error"]
        found = [(e["file"], e["line"] - 1, e["message"]) for e in errors]
    first = HEAD.count("\n")
    return {(Path(file).stem, line - first): message for file, line, message in found}


@pytest.mark.parametrize("checker", ["pyright", "mypy"])
def test_typical_use_is_right_and_each_typical_slip_is_an_error(
    tmp_path: Path, checker: str
) -> None:
    right, wrong = tmp_path / "right.py", tmp_path / "slips.py"
    slips = (*SLIPS, *SLIPS_WITH_BUILD123D) if checker == "pyright" else SLIPS
    write(right, RIGHT)
    write(wrong, "\n".join(slips) + "\n")
    found = faults(checker, [right, wrong])
    assert [message for (file, _), message in found.items() if file == "right"] == []
    assert [slip for line, slip in enumerate(slips) if ("slips", line) not in found] == []


@pytest.mark.parametrize("package", [wrinkle_cad, wrinkle_cad.strip], ids=lambda p: p.__name__)
def test_names_for_type_checkers_are_those_found_at_run_time(package: object) -> None:
    import ast

    path = Path(package.__file__)  # type: ignore[attr-defined]
    shown = {
        (alias.asname, node.module)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and node.level == 1
        for alias in node.names
        if alias.name == alias.asname
    }
    assert shown == set(package._MODULE_OF.items())  # type: ignore[attr-defined]
    assert {name for name, _ in shown} <= set(package.__all__)  # type: ignore[attr-defined]
    for name, module in shown:
        found = getattr(import_module(f"{package.__name__}.{module}"), name)  # type: ignore[attr-defined]
        assert getattr(package, name) is found


def test_help_lists_every_option_of_a_strip_and_of_its_pattern() -> None:
    strip_class = wrinkle_cad.WrinkleStrip
    for function, options in (
        (strip_class.__init__, StripSettings),
        (strip_class.pattern, PieceSettings),
    ):
        signature = inspect.signature(function)
        for name, option in options_of(options).items():
            assert signature.parameters[name].default == option.default
            assert f"    {name}: " in str(function.__doc__)
    assert list(inspect.signature(strip_class).parameters)[:2] == ["p", "q"]


def test_an_option_that_does_not_exist_is_named_with_what_was_meant() -> None:
    with pytest.raises(wrinkle_cad.InputError, match="did you mean tolerance"):
        wrinkle_cad.WrinkleStrip([[0, 0, 0]], [[0, 1, 0]], tolernce=0.1)  # type: ignore[call-arg]
