"""Statements of compiled functions."""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from types import FunctionType
from typing import Any

from .arrays import Lazy
from .expressions import Expressions, Program, result_ir
from .kinds import (
    INT,
    NOTHING,
    Array,
    CannotCompileError,
    Kind,
    Record,
    Scalar,
    holds_array,
    joined,
    leaves_of,
)
from .operations import Operand
from .writer import Block, Value


class Statements(Expressions):
    """Writes one function, given what its variables were found to be so far."""

    def __init__(
        self,
        function: FunctionType,
        program: Program,
        types: dict[str, Kind],
        result: Kind | None,
        set_names: frozenset[str],
    ) -> None:
        super().__init__(function, program, types)
        self._set_names = set_names
        self.result = result
        self._loops: list[tuple[Block, Block]] = []
        self._is_owner = result is None or not holds_array(result)
        if self._is_owner:
            self.list = self.w.slot("ptr", "null")

    def body(self, nodes: Sequence[ast.stmt]) -> str:
        """The text of the whole function."""
        self.statements(nodes)
        if not self.w.block.is_ended:
            self._leave(self.w.record([]))
        self.w.enter(self.failed)
        whole = result_ir(self.result or NOTHING)
        self._release()
        failed = self.w.get(f"insertvalue {whole} zeroinitializer, i1 true, 0")
        self.w.leave(f"ret {whole} {failed}")
        return self.w.text()

    def statements(self, nodes: Sequence[ast.stmt]) -> None:
        """Statements in order; none after one that leaves."""
        for node in nodes:
            if self.w.block.is_ended:
                return
            self._statement(node)

    def _statement(self, node: ast.stmt) -> None:
        how: Callable[[Any], None] | None = getattr(
            self, f"_do_{type(node).__name__.lower()}", None
        )
        if how is None:
            raise CannotCompileError(f"compiled functions cannot have {ast.unparse(node)}")
        try:
            how(node)
        except CannotCompileError as error:
            if getattr(error, "line", None) is None:
                error.line = node.lineno  # type: ignore[attr-defined]
            raise

    def set(self, name: str, value: Value) -> None:
        """Gives a variable a value; what kind the variable is may grow by it."""
        kind = joined(self.types[name], value.kind) if name in self.types else value.kind
        if self.types.get(name) != kind:
            self.types[name] = kind
            self.slots[name] = self.w.slots_of(kind)
        if name not in self.slots:
            self.slots[name] = self.w.slots_of(kind)
        self.w.store(value, kind, self.slots[name])

    def _do_expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):
            self.value(node.value)

    def _do_pass(self, _: ast.Pass) -> None:
        pass

    def _do_assign(self, node: ast.Assign) -> None:
        is_cut = any(isinstance(target, ast.Subscript) for target in node.targets)
        value = self.operand(node.value) if is_cut else self.value(node.value)
        for target in node.targets:
            self._assign(target, value)

    def _do_annassign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self._assign(node.target, self.value(node.value))

    def _assign(self, target: ast.expr, value: Operand) -> None:
        if isinstance(target, ast.Subscript):
            self._assign_place(target, value)
            return
        own = self.arrays.done(value) if isinstance(value, Lazy) else value
        if isinstance(target, ast.Name):
            self.set(target.id, own)
        elif isinstance(target, ast.Tuple):
            parts = self._unpacked(own, len(target.elts))
            for each, part in zip(target.elts, parts, strict=True):
                self._assign(each, part)
        else:
            raise CannotCompileError(f"compiled functions cannot set {ast.unparse(target)}")

    def _unpacked(self, value: Value, count: int) -> list[Value]:
        if not isinstance(value.kind, Array):
            return self.w.parts(value)
        if value.kind.ndim == 1:
            return [self.arrays.load(value, [str(at)]) for at in range(count)]
        raise CannotCompileError("an array of more axes is unpacked")

    def _assign_place(self, target: ast.Subscript, value: Operand) -> None:
        array, indices = self.value(target.value), self.indices(target.slice)
        whole = self.full_index(array, indices)
        if whole is not None and isinstance(value, Value):
            self.arrays.store(array, whole, value)
            return
        view = self.arrays.view(array, indices)
        if isinstance(value, Value) and isinstance(value.kind, Record):
            for at, part in enumerate(self.w.parts(value)):
                self.arrays.store(view, [str(at)], part)
        elif isinstance(value, Value) and isinstance(value.kind, Scalar):
            self.arrays.fill(view, value)
        else:
            self.arrays.write(view, value)

    def _do_augassign(self, node: ast.AugAssign) -> None:
        if isinstance(node.target, ast.Name):
            name = ast.Name(node.target.id, ast.Load())
            first = self.value(name)
            if isinstance(first.kind, Array):
                self._change(first, node.op, self.operand(node.value))
                return
            value = self.do.binary(node.op, first, self.value(node.value))
            assert isinstance(value, Value)
            self.set(node.target.id, value)
            return
        if not isinstance(node.target, ast.Subscript):
            raise CannotCompileError(f"compiled functions cannot set {ast.unparse(node.target)}")
        array, indices = self.value(node.target.value), self.indices(node.target.slice)
        whole = self.full_index(array, indices)
        if whole is None:
            self._change(self.arrays.view(array, indices), node.op, self.operand(node.value))
            return
        first = self.arrays.load(array, whole)
        value = self.do.binary(node.op, first, self.value(node.value))
        assert isinstance(value, Value)
        self.arrays.store(array, whole, value)

    def _change(self, view: Value, operator: ast.operator, by: Operand) -> None:
        """Changes each element of an array."""
        changed = self.arrays.lazy(self.do.binary(operator, view, by))
        self.arrays.each(
            self.arrays.shape(view),
            lambda index: self.arrays.store(view, index, changed.at(index)),
        )

    def _do_return(self, node: ast.Return) -> None:
        self._leave(self.w.record([]) if node.value is None else self.value(node.value))

    def _leave(self, value: Value) -> None:
        kind = value.kind if self.result is None else joined(self.result, value.kind)
        self.result = kind
        own, whole = self.w.as_kind(value, kind), result_ir(kind)
        result = "zeroinitializer"
        for at, (ir, leaf) in enumerate(zip(leaves_of(kind), own.leaves, strict=True), start=1):
            result = self.w.get(f"insertvalue {whole} {result}, {ir} {leaf}, {at}")
        self._release()
        self.w.leave(f"ret {whole} {result}")

    def _release(self) -> None:
        """Frees what was allocated, unless it may be in the result: then the caller does."""
        if self._is_owner:
            first = self.w.get(f"load ptr, ptr {self.list}")
            self.w.do(f"call void @release(ptr {first})")

    def _do_if(self, node: ast.If) -> None:
        (test,) = self.truth(node.test)
        yes, no, end = self.w.new_block(), self.w.new_block(), self.w.new_block()
        self.w.branch(test, yes, no)
        for start, nodes in ((yes, node.body), (no, node.orelse)):
            self.w.enter(start)
            self.statements(nodes)
            if not self.w.block.is_ended:
                self.w.jump(end)
        self.w.enter(end)

    def _do_while(self, node: ast.While) -> None:
        w = self.w
        test, body, end = w.new_block(), w.new_block(), w.new_block()
        w.jump(test)
        w.enter(test)
        (truth,) = self.truth(node.test)
        w.branch(truth, body, end)
        w.enter(body)
        self._repeat(node.body, test, end)
        w.enter(end)

    def _repeat(self, nodes: Sequence[ast.stmt], again: Block, end: Block) -> None:
        """The inside of a loop."""
        self._loops.append((again, end))
        self.statements(nodes)
        self._loops.pop()
        if not self.w.block.is_ended:
            self.w.jump(again)

    def _do_break(self, _: ast.Break) -> None:
        self.w.jump(self._loops[-1][1])

    def _do_continue(self, _: ast.Continue) -> None:
        self.w.jump(self._loops[-1][0])

    def _do_for(self, node: ast.For) -> None:
        over = node.iter
        if isinstance(over, ast.Call) and self.static(over.func) is range:
            self._for_range(node, [self.value(each) for each in over.args])
            return
        value = self.value(over)
        if isinstance(value.kind, Record):
            self._for_parts(node, value)
            return
        raise CannotCompileError(f"compiled functions cannot go through {ast.unparse(over)}")

    def _for_range(self, node: ast.For, bounds: list[Value]) -> None:
        w = self.w
        one, zero = w.constant(1), w.constant(0)
        start, stop, step = ([zero, *bounds, one] if len(bounds) == 1 else [*bounds, one])[:3]
        if not isinstance(step.known, int) or step.known == 0:
            raise CannotCompileError("the step of a range is no number written there")
        (first,), (last,) = (w.as_scalar(bound, INT).leaves for bound in (start, stop))
        slot = w.slot("i64")
        w.do(f"store i64 {first}, ptr {slot}")
        test, body, again, end = (w.new_block() for _ in range(4))
        w.jump(test)
        w.enter(test)
        at = w.get(f"load i64, ptr {slot}")
        order = "slt" if step.known > 0 else "sgt"
        w.branch(w.get(f"icmp {order} i64 {at}, {last}"), body, end)
        w.enter(body)
        self._assign(node.target, Value(INT, (at,)))
        self._repeat(node.body, again, end)
        w.enter(again)
        w.do(f"store i64 {w.get(f'add nsw i64 {at}, {step.known}')}, ptr {slot}")
        w.jump(test)
        w.enter(end)

    def _for_parts(self, node: ast.For, value: Value) -> None:
        """The loop written out, once for each part of a tuple."""
        end = self.w.new_block()
        for part in self.w.parts(value):
            more = self.w.new_block()
            self._assign(node.target, part)
            self._repeat(node.body, more, end)
            self.w.enter(more)
        self.w.jump(end)
        self.w.enter(end)

    def take(self, name: str, kind: Kind, leaves: tuple[str, ...]) -> None:
        """Gives a parameter what the caller gave; one that is never set needs no memory."""
        value = Value(kind, leaves)
        if name in self._set_names:
            self.set(name, value)
        else:
            self.fixed[name] = value
