"""All functions that one compiled function needs, as one text in LLVM's language."""

from __future__ import annotations

import ast
import linecache
from dataclasses import dataclass, field
from functools import lru_cache
from types import FunctionType
from typing import Any

import numpy.typing as npt

from .arrays import RUNTIME
from .expressions import Program, result_ir
from .kinds import CannotCompileError, Kind, Record, holds_array, leaves_of
from .statements import Statements
from .store import spelled

_ROUNDS = 12
"""Kinds of variables grow from round to round, at most from bool to float."""


@dataclass(slots=True)
class Translation(Program):
    """The text, and all that it was made from."""

    texts: list[str] = field(default_factory=list)
    """One per function."""
    files: set[str] = field(default_factory=set)
    """Source files."""
    constants: set[tuple[str, str, str]] = field(default_factory=set)
    """Module, name and spelling of constants that the code holds."""
    arrays: list[str] = field(default_factory=list)
    """Those of them that are arrays."""
    _known: dict[tuple[FunctionType, tuple[Kind, ...]], tuple[str, Kind]] = field(
        default_factory=dict
    )
    """Names and results of the functions so far."""

    def depend(self, module: str, name: str, value: object) -> None:
        """Says that the code holds a constant of a module."""
        self.constants.add((module, name, spelled(value)))

    def address_of(self, array: npt.NDArray[Any]) -> str:
        """Where the code holds an array of a module."""
        name = f"@held{len(self.arrays)}"
        content = "".join(f"\\{byte:02X}" for byte in array.tobytes())
        self.arrays.append(
            f'{name} = private constant [{array.nbytes} x i8] c"{content}", align 16'
        )
        return name

    def result_of(self, function: FunctionType, kinds: tuple[Kind, ...]) -> tuple[str, Kind]:
        """Name and result of a function for arguments of some kinds; translates it at first."""
        key = (function, kinds)
        if key not in self._known:
            name = f"f{len(self._known)}_{function.__name__.strip('<>')}"
            self._known[key] = self._translated(function, kinds, name)
        return self._known[key]

    def _translated(
        self, function: FunctionType, kinds: tuple[Kind, ...], name: str
    ) -> tuple[str, Kind]:
        node = definition_of(function)
        self.files.add(function.__code__.co_filename)
        given = node.args
        listed = (*given.posonlyargs, *given.args, *given.kwonlyargs)
        names = [argument.arg for argument in listed]
        types: dict[str, Kind] = dict(zip(names, kinds, strict=True))
        set_names = frozenset(
            each.id
            for each in ast.walk(node)
            if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)
        )
        result: Kind | None = None
        try:
            for _ in range(_ROUNDS):
                before = (dict(types), result)
                parameters: list[str] = []
                writing = Statements(function, self, types, result, set_names)
                for own, kind in zip(names, kinds, strict=True):
                    leaves = tuple(f"%a{len(parameters) + k}" for k in range(len(leaves_of(kind))))
                    parameters += [
                        f"{ir} {leaf}" for ir, leaf in zip(leaves_of(kind), leaves, strict=True)
                    ]
                    writing.take(own, kind, leaves)
                body = writing.body(node.body)
                result = writing.result
                if (types, result) == before:
                    break
        except CannotCompileError as error:
            line = getattr(error, "line", node.lineno)
            place = f"{function.__code__.co_filename}:{line}"
            raise CannotCompileError(f"{place}, {function.__name__}: {error}") from None
        assert result is not None
        head = f"{result_ir(result)} @{name}({', '.join([*parameters, 'ptr %list'])})"
        self.texts.append(f"define internal {head} nounwind {{\n{body}\n}}\n")
        return name, result


def whole_text(
    function: FunctionType, kinds: tuple[Kind, ...], entry: str
) -> tuple[str, Kind, Translation]:
    """A module whose function ``entry`` takes its arguments from memory.

    ``entry(arguments, results)`` reads the leaves of all arguments, 8 bytes each, and writes
    those of the result: before them its memory, to be freed by ``entry_free``; returns 1 for want
    of memory.
    """
    translation = Translation()
    name, result = translation.result_of(function, kinds)
    lines, given = [], []
    for at, ir in enumerate(leaves_of(Record(kinds))):
        lines += [f"  %p{at} = getelementptr i64, ptr %arguments, i64 {at}"]
        lines += [f"  %v{at} = load {'i8' if ir == 'i1' else ir}, ptr %p{at}"]
        lines += [f"  %t{at} = trunc i8 %v{at} to i1"] if ir == "i1" else []
        given.append(f"{ir} {'%t' if ir == 'i1' else '%v'}{at}")
    whole = result_ir(result)
    lines.append(f"  %r = call {whole} @{name}({', '.join([*given, 'ptr %results'])})")
    for at, ir in enumerate(leaves_of(result), start=1):
        lines.append(f"  %e{at} = extractvalue {whole} %r, {at}")
        lines.append(f"  %x{at} = zext i1 %e{at} to i64" if ir == "i1" else "")
        wide, leaf = ("i64", f"%x{at}") if ir == "i1" else (ir, f"%e{at}")
        lines.append(f"  %q{at} = getelementptr i64, ptr %results, i64 {at}")
        lines.append(f"  store {wide} {leaf}, ptr %q{at}")
    body = "\n".join(lines)
    ends = f"""
define i32 @{entry}(ptr %arguments, ptr %results) nounwind {{
  store ptr null, ptr %results
{body}
  %failed = extractvalue {whole} %r, 0
  %code = zext i1 %failed to i32
  ret i32 %code
}}
define void @{entry}_free(ptr %first) nounwind {{
  call void @release(ptr %first)
  ret void
}}
"""
    assert holds_array(result) or True
    return RUNTIME + "\n".join((*translation.arrays, *translation.texts, ends)), result, translation


@lru_cache(maxsize=256)
def _definitions(filename: str, _: int) -> dict[tuple[str, int], ast.FunctionDef]:
    tree = ast.parse("".join(linecache.getlines(filename)))
    found = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            first = min([node.lineno, *(each.lineno for each in node.decorator_list)])
            found[node.name, first] = node
    return found


def definition_of(function: FunctionType) -> ast.FunctionDef:
    """The syntax tree of a function.

    Raises:
        CannotCompileError: there is no source, or it is no ``def``.
    """
    code = function.__code__
    lines = linecache.getlines(code.co_filename)
    found = _definitions(code.co_filename, hash(tuple(lines)))
    key = (code.co_name, code.co_firstlineno)
    if key not in found:
        raise CannotCompileError(f"the source of {function.__qualname__} is not there")
    return found[key]
