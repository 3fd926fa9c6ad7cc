"""Text of one function in LLVM's language: blocks of instructions, registers, slots of memory."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import Final

from .kinds import BOOL, FLOAT, INT, Array, CannotCompileError, Kind, Record, Scalar, leaves_of


@dataclass(frozen=True, slots=True)
class Value:
    """A value: the registers or constants of all its leaves."""

    kind: Kind
    """What it is."""
    leaves: tuple[str, ...]
    """Operands, as many as `leaves_of(kind)`."""
    known: int | float | bool | None = None
    """What it is if that is known while compiling."""


@dataclass(slots=True)
class Block:
    """Instructions that run one after the other."""

    label: str
    """Its name."""
    lines: list[str] = field(default_factory=list)
    """Instructions."""
    is_ended: bool = False
    """Whether it has left for another block."""


_FLOAT_BITS: Final = struct.Struct(">d")


def float_text(number: float) -> str:
    """A double, to the bit."""
    return f"0x{_FLOAT_BITS.pack(number).hex().upper()}"


class Writer:
    """Writes the instructions of one function."""

    def __init__(self) -> None:
        self._count = 0
        self._slots: list[str] = []
        self._blocks: list[Block] = []
        self.block = self.new_block()
        self.enter(self.block)

    def text(self) -> str:
        """The body: slots first, then all blocks."""
        lines = ["begin:", *self._slots, f"  br label %{self._blocks[0].label}"]
        for block in self._blocks:
            lines.append(f"{block.label}:")
            lines += block.lines
            if not block.is_ended:
                lines.append("  unreachable")
        return "\n".join(lines)

    def new_block(self) -> Block:
        """A block that `enter` puts into the function."""
        self._count += 1
        return Block(f"b{self._count}")

    def enter(self, block: Block) -> None:
        """Continues in a block that was not entered before."""
        self._blocks.append(block)
        self.block = block

    def do(self, instruction: str) -> None:
        """An instruction without a result."""
        if not self.block.is_ended:
            self.block.lines.append(f"  {instruction}")

    def get(self, instruction: str) -> str:
        """An instruction's result, a register."""
        self._count += 1
        register = f"%r{self._count}"
        self.do(f"{register} = {instruction}")
        return register

    def jump(self, to: Block) -> None:
        """Leaves the block."""
        self.do(f"br label %{to.label}")
        self.block.is_ended = True

    def branch(self, condition: str, yes: Block, no: Block) -> None:
        """Leaves the block for one of two."""
        self.do(f"br i1 {condition}, label %{yes.label}, label %{no.label}")
        self.block.is_ended = True

    def leave(self, instruction: str) -> None:
        """Ends the function."""
        self.do(instruction)
        self.block.is_ended = True

    def slot(self, ir: str, start: str | None = None) -> str:
        """Memory for as long as the function runs; written with ``start`` once."""
        self._count += 1
        name = f"%s{self._count}"
        self._slots.append(f"  {name} = alloca {ir}")
        if start is not None:
            self._slots.append(f"  store {ir} {start}, ptr {name}")
        return name

    def slots_of(self, kind: Kind) -> tuple[str, ...]:
        """Memory for a value."""
        return tuple(self.slot(leaf) for leaf in leaves_of(kind))

    def load(self, kind: Kind, slots: tuple[str, ...]) -> Value:
        """The value that stands in slots."""
        pairs = zip(leaves_of(kind), slots, strict=True)
        return Value(kind, tuple(self.get(f"load {ir}, ptr {slot}") for ir, slot in pairs))

    def store(self, value: Value, kind: Kind, slots: tuple[str, ...]) -> None:
        """Writes a value into slots of a kind that it can become."""
        own = self.as_kind(value, kind)
        for ir, leaf, slot in zip(leaves_of(kind), own.leaves, slots, strict=True):
            self.do(f"store {ir} {leaf}, ptr {slot}")

    def as_kind(self, value: Value, kind: Kind) -> Value:
        """A value as another kind that it can become.

        Raises:
            CannotCompileError: it cannot.
        """
        if value.kind == kind:
            return value
        if isinstance(kind, Scalar) and isinstance(value.kind, Scalar):
            return self.as_scalar(value, kind)
        if isinstance(kind, Array) and isinstance(value.kind, Array):
            size = str(kind.element.size)
            if kind.ndim == value.kind.ndim and value.kind.is_dense and not kind.is_dense:
                return Value(kind, (*value.leaves, size))
        if isinstance(kind, Record) and isinstance(value.kind, Record):
            parts = zip(self.parts(value), kind.parts, strict=True)
            return self.record([self.as_kind(part, goal) for part, goal in parts], kind.maker)
        raise CannotCompileError(f"{value.kind} cannot become {kind}")

    def as_scalar(self, value: Value, kind: Scalar) -> Value:
        """A number as another kind of number; a float becomes an integer towards zero."""
        if not isinstance(value.kind, Scalar):
            raise CannotCompileError(f"{value.kind} is no number")
        if value.kind == kind:
            return value
        if value.known is not None:
            return self.constant({FLOAT: float, INT: int, BOOL: bool}[kind](value.known))
        (leaf,) = value.leaves
        if kind == BOOL:
            test = (
                f"fcmp une double {leaf}, 0.0" if value.kind == FLOAT else f"icmp ne i64 {leaf}, 0"
            )
            return Value(kind, (self.get(test),))
        how = {(INT, FLOAT): "sitofp", (BOOL, FLOAT): "uitofp", (BOOL, INT): "zext"}
        word = how.get((value.kind, kind), "fptosi")
        return Value(kind, (self.get(f"{word} {value.kind.ir} {leaf} to {kind.ir}"),))

    def constant(self, number: float | bool) -> Value:
        """A number that is known."""
        if isinstance(number, bool):
            return Value(BOOL, ("true" if number else "false",), number)
        if isinstance(number, int):
            return Value(INT, (str(number),), number)
        return Value(FLOAT, (float_text(number),), number)

    def record(self, parts: list[Value], maker: type | None = None) -> Value:
        """A tuple of values."""
        kind = Record(tuple(part.kind for part in parts), maker)
        return Value(kind, tuple(leaf for part in parts for leaf in part.leaves))

    def parts(self, value: Value) -> list[Value]:
        """What a tuple holds."""
        if not isinstance(value.kind, Record):
            raise CannotCompileError(f"{value.kind} is no tuple")
        parts, at = [], 0
        for kind in value.kind.parts:
            count = len(leaves_of(kind))
            leaves = value.leaves[at : at + count]
            parts.append(Value(kind, leaves, known_of(kind, leaves)))
            at += count
        return parts


def known_of(kind: Kind, leaves: tuple[str, ...]) -> int | float | bool | None:
    """The number that a leaf spells."""
    if not isinstance(kind, Scalar) or leaves[0].startswith("%"):
        return None
    if kind == BOOL:
        return leaves[0] == "true"
    if kind == INT:
        return int(leaves[0])
    number: float = _FLOAT_BITS.unpack(bytes.fromhex(leaves[0][2:]))[0]
    return number
