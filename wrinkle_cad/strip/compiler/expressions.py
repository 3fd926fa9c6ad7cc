"""Expressions of compiled functions."""

from __future__ import annotations

import ast
import builtins
import inspect
from collections.abc import Callable, Mapping, Sequence
from types import FunctionType, ModuleType
from typing import Any, Final, Protocol

import numpy as np
import numpy.typing as npt

from .arrays import Arrays, Cut, Index, Lazy
from .calls import Calls
from .kinds import (
    BOOL,
    Array,
    CannotCompileError,
    Kind,
    Record,
    element_of,
    joined,
    leaves_of,
)
from .library import SEARCHSORTED
from .operations import Operand, Operations
from .writer import Block, Value, Writer

_MISSING: Final = object()


class Program(Protocol):
    """What a function needs to know of the others."""

    def result_of(self, function: FunctionType, kinds: tuple[Kind, ...]) -> tuple[str, Kind]:
        """Name and result of a compiled function for arguments of some kinds."""

    def depend(self, module: str, name: str, value: object) -> None:
        """Says that the code holds a constant of a module."""

    def address_of(self, array: npt.NDArray[Any]) -> str:
        """Where the code holds an array of a module."""


def plain(function: object) -> FunctionType | None:
    """The Python function of a compiled one; None of anything else."""
    own = getattr(function, "py_func", None)
    return own if isinstance(own, FunctionType) else None


class Expressions:
    """Writes expressions into a function."""

    def __init__(self, function: FunctionType, program: Program, types: dict[str, Kind]) -> None:
        self.w = Writer()
        self.arrays = Arrays(self.w, self._allocated)
        self.do = Operations(self.w, self.arrays)
        self.calls = Calls(self.w, self.arrays, self.do)
        self.types = types
        self.slots: dict[str, tuple[str, ...]] = {}
        self.fixed: dict[str, Value] = {}
        self.failed = self.w.new_block()
        self.list = "%list"
        self._function = function
        self._program = program
        self._locals = set(function.__code__.co_varnames)
        self._closure = inspect.getclosurevars(function).nonlocals if function.__closure__ else {}

    def value(self, node: ast.expr) -> Value:
        """An expression, its arithmetic done."""
        value = self.operand(node)
        return self.arrays.done(value) if isinstance(value, Lazy) else value

    def operand(self, node: ast.expr) -> Operand:
        """An expression; arithmetic on arrays may be pending."""
        known = self.static(node)
        if known is not _MISSING:
            return self._constant(known)
        how: Callable[[Any], Operand] | None = getattr(
            self, f"_{type(node).__name__.lower()}", None
        )
        if how is None:
            raise CannotCompileError(f"compiled functions cannot have {ast.unparse(node)}")
        return how(node)

    def static(self, node: ast.expr) -> object:
        """What an expression is of things that are known while compiling, else _MISSING."""
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.Name) and node.id not in self._locals:
            return self._global(node.id)
        if isinstance(node, ast.Attribute):
            owner = self.static(node.value)
            if isinstance(owner, ModuleType):
                return getattr(owner, node.attr)
        return _MISSING

    def _global(self, name: str) -> object:
        if name in self._closure:
            return self._closure[name]
        known = self._function.__globals__
        if name not in known:
            return getattr(builtins, name)
        value: object = known[name]
        if isinstance(value, bool | int | float | tuple | np.ndarray):
            self._program.depend(self._function.__module__, name, value)
        return value

    def _constant(self, known: object) -> Value:
        if isinstance(known, bool | int | float):
            return self.w.constant(float(known) if isinstance(known, np.floating) else known)
        if isinstance(known, tuple):
            maker = type(known) if hasattr(known, "_fields") else None
            return self.w.record([self._constant(part) for part in known], maker)
        if isinstance(known, np.ndarray) and known.ndim:
            own = np.ascontiguousarray(known)
            sizes = tuple(map(str, (*own.shape, *own.strides[:-1])))
            kind = Array(element_of(own.dtype), own.ndim, is_dense=True)
            return Value(kind, (self._program.address_of(own), *sizes))
        raise CannotCompileError(f"compiled functions cannot hold {known!r}")

    def _name(self, node: ast.Name) -> Value:
        if node.id in self.fixed:
            return self.fixed[node.id]
        if node.id not in self.types:
            raise CannotCompileError(f"{node.id} is used before it is set")
        kind = self.types[node.id]
        if node.id not in self.slots:
            self.slots[node.id] = self.w.slots_of(kind)
        return self.w.load(kind, self.slots[node.id])

    def _tuple(self, node: ast.Tuple) -> Value:
        return self.w.record(self._all(node.elts))

    def _all(self, nodes: Sequence[ast.expr]) -> list[Value]:
        """Values of expressions; a starred one gives all its parts."""
        values: list[Value] = []
        for node in nodes:
            if isinstance(node, ast.Starred):
                values += self.w.parts(self.value(node.value))
            else:
                values.append(self.value(node))
        return values

    def _binop(self, node: ast.BinOp) -> Operand:
        first = self.operand(node.left)
        return self.do.binary(node.op, first, self.operand(node.right))

    def _unaryop(self, node: ast.UnaryOp) -> Operand:
        value = self.operand(node.operand)
        if isinstance(node.op, ast.USub):
            return self.do.negative(value)
        if isinstance(node.op, ast.Not) and isinstance(value, Value):
            return self.do.opposite(value)
        raise CannotCompileError(f"compiled functions cannot have {ast.unparse(node)}")

    def _compare(self, node: ast.Compare) -> Value:
        first, tests = self.value(node.left), []
        for operator, right in zip(node.ops, node.comparators, strict=True):
            second = self.value(right)
            tests.append(self.do.compare(operator, first, second))
            first = second
        return self.do.all_of(tests)

    def _boolop(self, node: ast.BoolOp) -> Value:
        """Both sides as truth values; the second is looked at only if it matters."""
        slot, end = self.w.slot("i1"), self.w.new_block()
        for number, each in enumerate(node.values):
            (leaf,) = self.truth(each)
            self.w.do(f"store i1 {leaf}, ptr {slot}")
            if number == len(node.values) - 1:
                self.w.jump(end)
                break
            more = self.w.new_block()
            is_and = isinstance(node.op, ast.And)
            self.w.branch(leaf, *((more, end) if is_and else (end, more)))
            self.w.enter(more)
        self.w.enter(end)
        return self.w.load(BOOL, (slot,))

    def truth(self, node: ast.expr) -> tuple[str, ...]:
        """Operand of an expression as a truth value."""
        return self.w.as_scalar(self.value(node), BOOL).leaves

    def _ifexp(self, node: ast.IfExp) -> Value:
        (test,) = self.truth(node.test)
        w, end = self.w, self.w.new_block()
        starts = (w.new_block(), w.new_block())
        w.branch(test, *starts)
        ends: list[tuple[Block, Value]] = []
        for start, each in zip(starts, (node.body, node.orelse), strict=True):
            w.enter(start)
            value = self.value(each)
            ends.append((w.block, value))
        kind = joined(ends[0][1].kind, ends[1][1].kind)
        slots = w.slots_of(kind)
        for block, value in ends:
            w.block = block
            w.store(value, kind, slots)
            w.jump(end)
        w.enter(end)
        return w.load(kind, slots)

    def _attribute(self, node: ast.Attribute) -> Value:
        return self.calls.attribute(self.value(node.value), node.attr)

    def _subscript(self, node: ast.Subscript) -> Value:
        value, indices = self.value(node.value), self.indices(node.slice)
        if isinstance(value.kind, Record):
            if len(indices) == 1 and isinstance(indices[0], Value):
                return self._part(value, indices[0])
            raise CannotCompileError("slices of tuples")
        whole = self.full_index(value, indices)
        return self.arrays.view(value, indices) if whole is None else self.arrays.load(value, whole)

    def indices(self, node: ast.expr) -> list[Index]:
        """What stands between brackets."""
        nodes = node.elts if isinstance(node, ast.Tuple) else [node]
        return [
            self._cut(each) if isinstance(each, ast.Slice) else self.value(each) for each in nodes
        ]

    def _cut(self, node: ast.Slice) -> Cut:
        step = 1 if node.step is None else self.value(node.step).known
        start, stop = (
            None if bound is None else self.value(bound) for bound in (node.lower, node.upper)
        )
        is_plain = isinstance(step, int) and step > 0
        if not is_plain and not (step == -1 and start is None and stop is None):
            raise CannotCompileError("compiled functions cut with written steps, or [::-1]")
        assert isinstance(step, int)
        return Cut(start, stop, step)

    def full_index(self, value: Value, indices: Sequence[Index]) -> list[str] | None:
        """Operands of the index of one element; None if it leaves an array."""
        shape = self.arrays.shape(value)
        numbers = [index for index in indices if isinstance(index, Value)]
        if len(numbers) < len(shape):
            return None
        return [self.arrays.wrapped(at, size) for at, size in zip(numbers, shape, strict=True)]

    def _part(self, value: Value, index: Value) -> Value:
        """A part of a tuple; which one may be known only when it runs: then all are alike."""
        parts = self.w.parts(value)
        if isinstance(index.known, int):
            return parts[index.known]
        kind = parts[0].kind
        for part in parts[1:]:
            kind = joined(kind, part.kind)
        at = self.arrays.wrapped(index, str(len(parts)))
        own = [self.w.as_kind(part, kind) for part in parts]
        leaves = []
        for number, ir in enumerate(leaves_of(kind)):
            memory = self.w.slot(f"[{len(parts)} x {ir}]")
            for place, part in enumerate(own):
                where = self.w.get(f"getelementptr inbounds {ir}, ptr {memory}, i64 {place}")
                self.w.do(f"store {ir} {part.leaves[number]}, ptr {where}")
            where = self.w.get(f"getelementptr inbounds {ir}, ptr {memory}, i64 {at}")
            leaves.append(self.w.get(f"load {ir}, ptr {where}"))
        return Value(kind, tuple(leaves))

    def _call(self, node: ast.Call) -> Operand:
        function = self.static(node.func)
        if function is _MISSING:
            if isinstance(node.func, ast.Attribute) and not node.args and not node.keywords:
                return self.calls.method(self.operand(node.func.value), node.func.attr)
            raise CannotCompileError(f"compiled functions cannot call {ast.unparse(node.func)}")
        own = plain(function)
        if own is not None:
            return self._compiled(own, node)
        if function is np.searchsorted:
            return self._searched(node)
        if isinstance(function, type) and hasattr(function, "_fields"):
            values = self._bound(inspect.signature(function), node)
            return self.w.record(values, function)
        named = {word.arg or "": self._given(word.value) for word in node.keywords}
        return self.calls.call(function, [self._given(each) for each in node.args], named)

    def _given(self, node: ast.expr) -> object:
        """An argument of one of numpy's functions: a dtype stays what it is."""
        known = self.static(node)
        return known if isinstance(known, type) else self.operand(node)

    def _bound(self, signature: inspect.Signature, node: ast.Call) -> list[Value]:
        """The values of all parameters, in order."""
        named = {word.arg or "": self.value(word.value) for word in node.keywords}
        bound = signature.bind(*self._all(node.args), **named)
        bound.apply_defaults()
        return [
            each if isinstance(each, Value) else self._constant(each)
            for each in bound.arguments.values()
        ]

    def _compiled(self, function: FunctionType, node: ast.Call) -> Value:
        return self.call(function, self._bound(inspect.signature(function), node))

    def _searched(self, node: ast.Call) -> Value:
        named: Mapping[str, object] = {w.arg or "": self.static(w.value) for w in node.keywords}
        ordered, value = self._all(node.args)
        value = self.w.as_scalar(value, _array(ordered).element.scalar)
        return self.call(SEARCHSORTED[str(named.get("side", "left"))], [ordered, value])

    def call(self, function: FunctionType, values: Sequence[Value]) -> Value:
        """Calls another function of this program."""
        name, kind = self._program.result_of(function, tuple(value.kind for value in values))
        given = [
            f"{ir} {leaf}"
            for value in values
            for ir, leaf in zip(leaves_of(value.kind), value.leaves, strict=True)
        ]
        whole = result_ir(kind)
        result = self.w.get(f"call {whole} @{name}({', '.join([*given, f'ptr {self.list}'])})")
        self._leave_if(self.w.get(f"extractvalue {whole} {result}, 0"))
        leaves = range(1, 1 + len(leaves_of(kind)))
        return Value(kind, tuple(self.w.get(f"extractvalue {whole} {result}, {k}") for k in leaves))

    def _allocated(self, size: str) -> str:
        place = self.w.get(f"call ptr @reserve(ptr {self.list}, i64 {size})")
        self._leave_if(self.w.get(f"icmp eq ptr {place}, null"))
        return place

    def _leave_if(self, test: str) -> None:
        """Ends the function for want of memory."""
        more = self.w.new_block()
        self.w.branch(test, self.failed, more)
        self.w.enter(more)


def result_ir(kind: Kind) -> str:
    """LLVM's type of what a function returns: whether it failed, then the value."""
    return "{ " + ", ".join(("i1", *leaves_of(kind))) + " }"


def _array(value: Value) -> Array:
    if not isinstance(value.kind, Array):
        raise CannotCompileError(f"{value.kind} is no array")
    return value.kind
