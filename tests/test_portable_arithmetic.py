"""What decides or is written takes its sums and angles where every processor gives the same."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "wrinkle_cad"
DECIDING = ("strip", "pattern", "cad")

# Sums in the order of a BLAS, or equations by LAPACK.
BLAS = {"dot", "vdot", "inner", "matmul", "matvec", "vecdot", "tensordot", "einsum", "lstsq"}
BLAS |= {"make_interp_spline", "make_lsq_spline", "CubicSpline", "leggauss", "polyfit", "polyint"}
# Functions that numpy takes from the vector unit; in compiled code they are the C library's.
VECTOR = {"exp", "expm1", "exp2", "log", "log1p", "log2", "log10", "power", "float_power", "cbrt"}
VECTOR |= {"sin", "cos", "tan", "arcsin", "arccos", "arctan", "arctan2", "sinh", "cosh", "tanh"}


def is_compiled(node: ast.FunctionDef) -> bool:
    return any(isinstance(mark, ast.Name) and mark.id == "compiled" for mark in node.decorator_list)


def processor_dependent(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Lines and names of what may differ between processors."""
    compiled = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and is_compiled(node)
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.MatMult):
            yield node.lineno, "@"
        elif isinstance(node, ast.Attribute):
            owner = ast.unparse(node.value)
            on_array = node.attr == "dot" or (owner == "np.linalg" and node.attr != "norm")
            in_numpy = owner.startswith("np") and node.attr in BLAS
            in_vector = owner == "np" and node.attr in VECTOR and id(node) not in compiled
            if on_array or in_numpy or in_vector:
                yield node.lineno, ast.unparse(node)
        elif isinstance(node, ast.Call) and ast.unparse(node.func) == "np.linalg.norm":
            if all(keyword.arg != "axis" for keyword in node.keywords):
                yield node.lineno, "norm without an axis"
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("scipy"):
            for name in node.names:
                if name.name in BLAS or "linalg" in (node.module or ""):
                    yield node.lineno, name.name


@pytest.mark.parametrize("folder", DECIDING)
def test_nothing_that_decides_depends_on_the_processor(folder: str) -> None:
    found = [
        f"{path.relative_to(PACKAGE)}:{line}: {name}"
        for path in sorted((PACKAGE / folder).rglob("*.py"))
        for line, name in processor_dependent(ast.parse(path.read_text(encoding="utf-8")))
    ]
    assert found == [], "use wrinkle_cad.strip.portable, math or compiled code"


@pytest.mark.parametrize(
    ("code", "found"),
    [
        ("a @ b", ["@"]),
        ("a @= b", ["@"]),
        ("np.dot(a, b)", ["np.dot"]),
        ("a.dot(b)", ["a.dot"]),
        ("np.einsum('ij,ij->i', a, a)", ["np.einsum"]),
        ("np.linalg.solve(a, b)", ["np.linalg.solve"]),
        ("np.linalg.norm(a)", ["norm without an axis"]),
        ("np.linalg.norm(a, axis=1)", []),
        ("np.arctan2(y, x)", ["np.arctan2"]),
        ("math.atan2(y, x)", []),
        ("@compiled\ndef f(x):\n    return np.cos(x)", []),
        ("def f(x):\n    return np.cos(x)", ["np.cos"]),
        ("from scipy.interpolate import make_interp_spline", ["make_interp_spline"]),
        ("from scipy.interpolate import BSpline", []),
        ("np.sqrt(a).sum()", []),
    ],
)
def test_the_search_sees_what_differs(code: str, found: list[str]) -> None:
    assert [name for _, name in processor_dependent(ast.parse(code))] == found
