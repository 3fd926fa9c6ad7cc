"""Arrays in compiled functions: memory, places, views, and arithmetic element by element."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

from .kinds import BOOL, INT, Array, CannotCompileError, Element, Scalar, element_of
from .writer import Value, Writer


@dataclass(frozen=True, slots=True)
class Cut:
    """A slice along one axis; None where Python's own bound stands."""

    start: Value | None
    """First index."""
    stop: Value | None
    """Index after the last."""
    step: int
    """1 or more, or -1 without bounds."""


@dataclass(frozen=True, slots=True)
class Lazy:
    """Arithmetic on arrays that has not been done yet."""

    scalar: Scalar
    """What an element is."""
    shape: tuple[str, ...]
    """Operands."""
    at: Callable[[Sequence[str]], Value]
    """Writes the instructions for one element."""


Index: TypeAlias = Value | Cut

RUNTIME: Final = """
declare ptr @malloc(i64)
declare ptr @calloc(i64, i64)
declare void @free(ptr)
declare double @sin(double)
declare double @cos(double)
declare double @atan2(double, double)
declare double @hypot(double, double)
declare double @llvm.sqrt.f64(double)
declare double @llvm.fabs.f64(double)
declare double @llvm.floor.f64(double)
declare double @llvm.ceil.f64(double)
declare i64 @llvm.smin.i64(i64, i64)
declare i64 @llvm.smax.i64(i64, i64)

define internal ptr @reserve(ptr %list, i64 %bytes) nounwind {
  %size = add i64 %bytes, 16
  %block = call ptr @calloc(i64 %size, i64 1)
  %failed = icmp eq ptr %block, null
  br i1 %failed, label %nothing, label %chain
chain:
  %next = load ptr, ptr %list
  store ptr %next, ptr %block
  store ptr %block, ptr %list
  %place = getelementptr i8, ptr %block, i64 16
  ret ptr %place
nothing:
  ret ptr null
}

define internal void @release(ptr %first) nounwind {
begin:
  br label %test
test:
  %block = phi ptr [ %first, %begin ], [ %next, %one ]
  %done = icmp eq ptr %block, null
  br i1 %done, label %end, label %one
one:
  %next = load ptr, ptr %block
  call void @free(ptr %block)
  br label %test
end:
  ret void
}
"""
"""Memory is chained per call, so that all of it is freed at its end. It comes as zeros: whoever
forgets to write an array gets the same bytes each time."""


class Arrays:
    """Writes what is done with arrays into a function."""

    def __init__(self, writer: Writer, allocate: Callable[[str], str]) -> None:
        """``allocate`` writes a request for so many bytes and leaves the function if it fails."""
        self._w = writer
        self._allocate = allocate

    def shape(self, value: Value | Lazy) -> tuple[str, ...]:
        """Operands of all sizes."""
        if isinstance(value, Lazy):
            return value.shape
        return value.leaves[1 : 1 + _array(value).ndim]

    def size(self, value: Value | Lazy) -> str:
        """Operand of the number of elements."""
        return self._product(self.shape(value))

    def make(self, element: Element, shape: Sequence[str]) -> Value:
        """New memory, all zeros."""
        w = self._w
        count = self._product(shape)
        place = self._allocate(w.get(f"mul nsw i64 {count}, {element.size}"))
        strides: list[str] = []
        for k in range(1, len(shape)):
            inner = self._product(shape[k:])
            strides.append(w.get(f"mul nsw i64 {inner}, {element.size}"))
        return Value(Array(element, len(shape), True), (place, *shape, *strides))

    def load(self, value: Value, index: Sequence[str]) -> Value:
        """One element."""
        element = _array(value).element
        raw = self._w.get(f"load {element.ir}, ptr {self.place(value, index)}")
        if element.scalar == BOOL:
            raw = self._w.get(f"icmp ne i8 {raw}, 0")
        elif element.scalar.ir != element.ir:
            word = "sext" if element.is_signed else "zext"
            raw = self._w.get(f"{word} {element.ir} {raw} to i64")
        return Value(element.scalar, (raw,))

    def store(self, value: Value, index: Sequence[str], number: Value) -> None:
        """Writes one element."""
        element = _array(value).element
        (raw,) = self._w.as_scalar(number, element.scalar).leaves
        if element.scalar.ir != element.ir:
            word = "zext" if element.scalar == BOOL else "trunc"
            raw = self._w.get(f"{word} {element.scalar.ir} {raw} to {element.ir}")
        self._w.do(f"store {element.ir} {raw}, ptr {self.place(value, index)}")

    def place(self, value: Value, index: Sequence[str]) -> str:
        """Address of one element."""
        kind = _array(value)
        address = value.leaves[0]
        strides = value.leaves[1 + kind.ndim :]
        for at, stride in zip(index, strides, strict=False):
            offset = self._w.get(f"mul nsw i64 {at}, {stride}")
            address = self._w.get(f"getelementptr inbounds i8, ptr {address}, i64 {offset}")
        if kind.is_dense:
            ir = kind.element.ir
            address = self._w.get(f"getelementptr inbounds {ir}, ptr {address}, i64 {index[-1]}")
        return address

    def view(self, value: Value, indices: Sequence[Index]) -> Value:
        """What an index with at least one cut leaves of an array."""
        kind, w = _array(value), self._w
        cuts = [*indices, *[Cut(None, None, 1)] * (kind.ndim - len(indices))]
        strides = [*value.leaves[1 + kind.ndim :]]
        if kind.is_dense:
            strides.append(str(kind.element.size))
        address, shape, kept = value.leaves[0], [], []
        for cut, size, stride in zip(cuts, self.shape(value), strides, strict=True):
            if isinstance(cut, Value):
                start = self.wrapped(cut, size)
            else:
                start, length = self._bounds(cut, size)
                shape.append(length)
                kept.append(w.get(f"mul nsw i64 {stride}, {cut.step}") if cut.step != 1 else stride)
            if start != "0":
                offset = w.get(f"mul nsw i64 {start}, {stride}")
                address = w.get(f"getelementptr inbounds i8, ptr {address}, i64 {offset}")
        last = cuts[-1]
        is_dense = kind.is_dense and isinstance(last, Cut) and last.step == 1
        made = Array(kind.element, len(shape), is_dense)
        return Value(made, (address, *shape, *(kept[:-1] if is_dense else kept)))

    def wrapped(self, index: Value, size: str) -> str:
        """An index; a negative one counts from the end."""
        if index.kind not in (INT, BOOL):
            raise CannotCompileError(f"an index is {index.kind}")
        if index.known is not None and index.known >= 0:
            return str(int(index.known))
        (at,) = self._w.as_scalar(index, INT).leaves
        behind = self._w.get(f"add nsw i64 {at}, {size}")
        if index.known is not None:
            return behind
        is_negative = self._w.get(f"icmp slt i64 {at}, 0")
        return self._w.get(f"select i1 {is_negative}, i64 {behind}, i64 {at}")

    def _bounds(self, cut: Cut, size: str) -> tuple[str, str]:
        """First index and length of a cut, which ends where the array does."""
        w = self._w
        if cut.step == -1:
            return w.get(f"sub nsw i64 {size}, 1"), size
        start = "0" if cut.start is None else self._clamped(cut.start, size)
        stop = size if cut.stop is None else self._clamped(cut.stop, size)
        length = stop
        if start != "0":
            length = w.get(f"sub nsw i64 {stop}, {start}")
            length = w.get(f"call i64 @llvm.smax.i64(i64 {length}, i64 0)")
        if cut.step > 1:
            more = w.get(f"add nsw i64 {length}, {cut.step - 1}")
            length = w.get(f"sdiv i64 {more}, {cut.step}")
        return start, length

    def _clamped(self, bound: Value, size: str) -> str:
        at = self.wrapped(bound, size)
        if at == "0":
            return at
        low = self._w.get(f"call i64 @llvm.smin.i64(i64 {at}, i64 {size})")
        if bound.known is not None and bound.known >= 0:
            return low
        return self._w.get(f"call i64 @llvm.smax.i64(i64 {low}, i64 0)")

    def lazy(self, value: Value | Lazy) -> Lazy:
        """An array as arithmetic that has not been done."""
        if isinstance(value, Lazy):
            return value
        scalar = _array(value).element.scalar
        return Lazy(scalar, self.shape(value), lambda index: self.load(value, index))

    def done(self, value: Lazy) -> Value:
        """New memory with the elements of pending arithmetic."""
        char = {"double": "d", "i64": "l", "i1": "?"}[value.scalar.ir]
        made = self.make(element_of("int64" if char == "l" else char), value.shape)
        self.each(value.shape, lambda index: self.store(made, index, value.at(index)))
        return made

    def fill(self, target: Value, number: Value) -> None:
        """Writes one number into every element."""
        self.each(self.shape(target), lambda index: self.store(target, index, number))

    def write(self, target: Value, source: Value | Lazy) -> None:
        """Copies elements; axes that an array lacks in front are repeated."""
        own = self.done(source) if isinstance(source, Lazy) else source
        skipped = _array(target).ndim - _array(own).ndim
        if skipped < 0:
            raise CannotCompileError("an array is written into one of fewer axes")
        self.each(
            self.shape(target),
            lambda index: self.store(target, index, self.load(own, index[skipped:])),
        )

    def each(self, shape: Sequence[str], do: Callable[[Sequence[str]], None]) -> None:
        """Writes loops over all indices, the last axis innermost."""
        self._each(shape, [], do)

    def _each(
        self, shape: Sequence[str], index: list[str], do: Callable[[Sequence[str]], None]
    ) -> None:
        if not shape:
            do(index)
            return
        self.loop(shape[0], lambda at: self._each(shape[1:], [*index, at], do))

    def loop(self, count: str, do: Callable[[str], None]) -> None:
        """Writes a loop from 0 to below a count."""
        w = self._w
        slot = w.slot("i64")
        w.do(f"store i64 0, ptr {slot}")
        test, body, end = w.new_block(), w.new_block(), w.new_block()
        w.jump(test)
        w.enter(test)
        at = w.get(f"load i64, ptr {slot}")
        w.branch(w.get(f"icmp slt i64 {at}, {count}"), body, end)
        w.enter(body)
        do(at)
        w.do(f"store i64 {w.get(f'add nsw i64 {at}, 1')}, ptr {slot}")
        w.jump(test)
        w.enter(end)

    def _product(self, sizes: Sequence[str]) -> str:
        product = sizes[0]
        for size in sizes[1:]:
            product = self._w.get(f"mul nsw i64 {product}, {size}")
        return product


def _array(value: Value) -> Array:
    if not isinstance(value.kind, Array):
        raise CannotCompileError(f"{value.kind} is no array")
    return value.kind
