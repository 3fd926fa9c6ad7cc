"""Arithmetic and comparisons of compiled functions, as Python and IEEE 754 have them.

Division by zero follows IEEE 754, as in numpy; that of integers gives 0.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Sequence
from typing import Final

from .arrays import Arrays, Lazy
from .kinds import BOOL, FLOAT, INT, CannotCompileError, Record, Scalar, joined
from .writer import Value, Writer

Operand = Value | Lazy

_PLAIN: Final[dict[type[ast.operator], tuple[str, str]]] = {
    ast.Add: ("fadd", "add"),
    ast.Sub: ("fsub", "sub"),
    ast.Mult: ("fmul", "mul"),
}
_BITS: Final[dict[type[ast.operator], str]] = {
    ast.BitAnd: "and",
    ast.BitOr: "or",
    ast.BitXor: "xor",
    ast.LShift: "shl",
    ast.RShift: "ashr",
}
_TESTS: Final[dict[type[ast.cmpop], tuple[str, str]]] = {
    ast.Lt: ("olt", "slt"),
    ast.LtE: ("ole", "sle"),
    ast.Gt: ("ogt", "sgt"),
    ast.GtE: ("oge", "sge"),
    ast.Eq: ("oeq", "eq"),
    ast.NotEq: ("une", "ne"),
}
_FOLDED: Final[dict[type[ast.operator], Callable[[int, int], int]]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
}


class Operations:
    """Writes arithmetic into a function."""

    def __init__(self, writer: Writer, arrays: Arrays) -> None:
        self._w = writer
        self._arrays = arrays

    def binary(self, operator: ast.operator, first: Operand, second: Operand) -> Operand:
        """Two operands, element by element if one is an array."""
        if not (_is_scalar(first) and _is_scalar(second)):
            return self.each((first, second), lambda own: self._scalars(operator, *own))
        assert isinstance(first, Value)
        assert isinstance(second, Value)
        return self._scalars(operator, first, second)

    def each(self, operands: Sequence[Operand], do: Callable[[Sequence[Value]], Value]) -> Operand:
        """A function of numbers, of each element where an operand is an array."""
        if all(_is_scalar(operand) for operand in operands):
            return do([operand for operand in operands if isinstance(operand, Value)])
        own = [
            operand if _is_scalar(operand) else self._arrays.lazy(operand) for operand in operands
        ]
        shape = max((each.shape for each in own if isinstance(each, Lazy)), key=len)

        def at(index: Sequence[str]) -> Value:
            return do(
                [
                    each.at(index[len(index) - len(each.shape) :])
                    if isinstance(each, Lazy)
                    else each
                    for each in own
                ]
            )

        samples = [_sample(each) for each in own]
        return Lazy(self._scalar_of(do, samples), shape, at)

    def _scalar_of(self, do: Callable[[Sequence[Value]], Value], samples: list[Value]) -> Scalar:
        """What kind of number a function gives; what it writes is unwritten again."""
        block, count = self._w.block, len(self._w.block.lines)
        kind = do(samples).kind
        if self._w.block is not block or not isinstance(kind, Scalar):
            raise CannotCompileError("arithmetic on arrays with branches in it")
        del block.lines[count:]
        return kind

    def _scalars(self, operator: ast.operator, first: Value, second: Value) -> Value:
        kinds = (first.kind, second.kind)
        if isinstance(operator, ast.Pow):
            return self._power(first, second)
        if type(operator) in _BITS:
            return self._bits(_BITS[type(operator)], first, second)
        if isinstance(operator, ast.Div):
            return self._numbers("fdiv", FLOAT, first, second)
        goal = FLOAT if FLOAT in kinds else INT
        if type(operator) in _PLAIN:
            of_floats, of_integers = _PLAIN[type(operator)]
            if goal == INT and isinstance(first.known, int) and isinstance(second.known, int):
                fold = _FOLDED[type(operator)]
                return self._w.constant(fold(int(first.known), int(second.known)))
            return self._numbers(of_floats if goal == FLOAT else of_integers, goal, first, second)
        if isinstance(operator, ast.FloorDiv | ast.Mod) and goal == INT:
            quotient, rest = self._divided(first, second)
            return quotient if isinstance(operator, ast.FloorDiv) else rest
        raise CannotCompileError(f"{type(operator).__name__} of {kinds}")

    def _numbers(self, word: str, kind: Scalar, first: Value, second: Value) -> Value:
        (a,), (b,) = (self._w.as_scalar(value, kind).leaves for value in (first, second))
        return Value(kind, (self._w.get(f"{word} {kind.ir} {a}, {b}"),))

    def _bits(self, word: str, first: Value, second: Value) -> Value:
        if FLOAT in (first.kind, second.kind):
            raise CannotCompileError("bits of a float")
        goal = BOOL if first.kind == second.kind == BOOL and "sh" not in word else INT
        return self._numbers(word, goal, first, second)

    def _power(self, base: Value, exponent: Value) -> Value:
        """Products of squares, as numba forms them."""
        rest = exponent.known
        if not isinstance(rest, int) or rest < 1 or not isinstance(base.kind, Scalar):
            raise CannotCompileError("a power whose exponent is no number written there")
        multiply = ast.Mult()
        product = None
        while True:
            if rest & 1:
                product = base if product is None else self._scalars(multiply, product, base)
            rest >>= 1
            if not rest:
                break
            base = self._scalars(multiply, base, base)
        assert product is not None
        return product

    def _divided(self, first: Value, second: Value) -> tuple[Value, Value]:
        """Quotient rounded down, and what remains; both 0 when divided by 0."""
        w = self._w
        (a,), (b,) = (w.as_scalar(value, INT).leaves for value in (first, second))
        none = w.get(f"icmp eq i64 {b}, 0")
        b = w.get(f"select i1 {none}, i64 1, i64 {b}")
        quotient, rest = w.get(f"sdiv i64 {a}, {b}"), w.get(f"srem i64 {a}, {b}")
        is_odd = w.get(f"icmp ne i64 {rest}, 0")
        signs = w.get(f"xor i64 {rest}, {b}")
        is_below = w.get(f"icmp slt i64 {signs}, 0")
        wrong = w.get(f"and i1 {is_odd}, {is_below}")
        lower, higher = w.get(f"sub i64 {quotient}, 1"), w.get(f"add i64 {rest}, {b}")
        quotient = w.get(f"select i1 {wrong}, i64 {lower}, i64 {quotient}")
        rest = w.get(f"select i1 {wrong}, i64 {higher}, i64 {rest}")
        quotient = w.get(f"select i1 {none}, i64 0, i64 {quotient}")
        rest = w.get(f"select i1 {none}, i64 0, i64 {rest}")
        return Value(INT, (quotient,)), Value(INT, (rest,))

    def negative(self, value: Operand) -> Operand:
        """A number, or each of an array's, with the other sign."""
        return self.each((value,), lambda own: self._negative(own[0]))

    def _negative(self, value: Value) -> Value:
        if value.known is not None and value.kind != BOOL:
            return self._w.constant(-value.known)
        if value.kind == FLOAT:
            return Value(FLOAT, (self._w.get(f"fneg double {value.leaves[0]}"),))
        return self._numbers("sub", INT, self._w.constant(0), value)

    def compare(self, operator: ast.cmpop, first: Value, second: Value) -> Value:
        """One comparison; tuples are equal if all their parts are."""
        if isinstance(operator, ast.In | ast.NotIn):
            tests = [self.compare(ast.Eq(), first, part) for part in self._w.parts(second)]
            found = self._all("or", tests)
            return self.opposite(found) if isinstance(operator, ast.NotIn) else found
        if isinstance(first.kind, Record):
            pairs = zip(self._w.parts(first), self._w.parts(second), strict=True)
            same = self._all("and", [self.compare(ast.Eq(), a, b) for a, b in pairs])
            return same if isinstance(operator, ast.Eq) else self.opposite(same)
        of_floats, of_integers = _TESTS[type(operator)]
        goal = FLOAT if FLOAT in (first.kind, second.kind) else INT
        (a,), (b,) = (self._w.as_scalar(value, goal).leaves for value in (first, second))
        test = f"fcmp {of_floats}" if goal == FLOAT else f"icmp {of_integers}"
        return Value(BOOL, (self._w.get(f"{test} {goal.ir} {a}, {b}"),))

    def all_of(self, tests: list[Value]) -> Value:
        """Whether all of them hold."""
        return self._all("and", tests)

    def _all(self, word: str, tests: list[Value]) -> Value:
        found = tests[0].leaves[0]
        for test in tests[1:]:
            found = self._w.get(f"{word} i1 {found}, {test.leaves[0]}")
        return Value(BOOL, (found,))

    def opposite(self, value: Value) -> Value:
        """Not."""
        (leaf,) = self._w.as_scalar(value, BOOL).leaves
        return Value(BOOL, (self._w.get(f"xor i1 {leaf}, true"),))

    def least(self, values: Sequence[Value], *, is_greatest: bool) -> Value:
        """Python's min or max: of equal ones the first; a NaN that comes first stays."""
        kind = values[0].kind
        for value in values[1:]:
            kind = joined(kind, value.kind)
        best = self._w.as_kind(values[0], kind)
        for value in values[1:]:
            own = self._w.as_kind(value, kind)
            test = self.compare(ast.Gt() if is_greatest else ast.Lt(), own, best).leaves[0]
            assert isinstance(kind, Scalar)
            chosen = f"select i1 {test}, {kind.ir} {own.leaves[0]}, {kind.ir} {best.leaves[0]}"
            best = Value(kind, (self._w.get(chosen),))
        return best

    def absolute(self, value: Value) -> Value:
        """Size without sign."""
        if value.kind == FLOAT:
            return self.intrinsic("llvm.fabs.f64", value)
        return self.least([value, self._negative(value)], is_greatest=True)

    def intrinsic(self, name: str, *values: Value) -> Value:
        """A function of floats that LLVM or the C library has."""
        own = [self._w.as_scalar(value, FLOAT).leaves[0] for value in values]
        given = ", ".join(f"double {leaf}" for leaf in own)
        return Value(FLOAT, (self._w.get(f"call double @{name}({given})"),))


def _is_scalar(value: Operand) -> bool:
    return isinstance(value, Value) and isinstance(value.kind, Scalar)


def _sample(operand: Operand) -> Value:
    """A number of the kind that an operand's elements are."""
    if isinstance(operand, Value):
        return operand
    kind = operand.scalar
    return Value(kind, {FLOAT: ("0x0000000000000000",), INT: ("0",), BOOL: ("false",)}[kind])
