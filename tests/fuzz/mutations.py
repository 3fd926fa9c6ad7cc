"""Damage to STEP files, as transfers, editors and other programs do it, and worse; seeded."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from typing import Final

HOSTILE_NUMBERS: Final = (b"0.", b"-1.", b"1.E308", b"-1.E308", b"NaN", b"INF", b"1.E-320", b"$")
_NUMBER: Final = re.compile(rb"-?\d+\.\d*(?:E[+-]?\d+)?")
_WHOLE: Final = re.compile(rb"(?<=[(,])\d+(?=[,)])")
_REFERENCE: Final = re.compile(rb"#\d+(?=[,)])")
_KEYWORD: Final = re.compile(rb"(?<=[= ])[A-Z][A-Z_0-9]+(?=\()")
_TEXT: Final = re.compile(rb"'[^']*'")
_HOSTILE_TEXTS: Final = (
    b"'../../x'",
    b"'/etc/passwd'",
    b"'CON'",
    b"'" + b"a" * 300 + b"'",
    rb"'\X2\D83D\X0\'",
    rb"'\X\00\X\0A'",
    b"'=cmd()'",
    b"'<script>alert(1)</script>'",
    b"'P'",
    b"'unclosed",
)

Mutation = Callable[[bytes, random.Random], bytes]


def flip_bytes(content: bytes, chance: random.Random) -> bytes:
    """Flips one bit in each of up to 20 bytes."""
    damaged = bytearray(content)
    for _ in range(chance.randint(1, 20)):
        if damaged:
            damaged[chance.randrange(len(damaged))] ^= 1 << chance.randrange(8)
    return bytes(damaged)


def drop_lines(content: bytes, chance: random.Random) -> bytes:
    """Drops up to five lines."""
    lines = content.splitlines(keepends=True)
    for _ in range(chance.randint(1, 5)):
        if lines:
            del lines[chance.randrange(len(lines))]
    return b"".join(lines)


def repeat_lines(content: bytes, chance: random.Random) -> bytes:
    """Repeats a run of lines somewhere else: identifiers occur twice."""
    lines = content.splitlines(keepends=True)
    start = chance.randrange(len(lines) + 1)
    target = chance.randrange(len(lines) + 1)
    lines[target:target] = lines[start : start + chance.randint(1, 10)]
    return b"".join(lines)


def cut_off(content: bytes, chance: random.Random) -> bytes:
    """Ends the file early."""
    return content[: chance.randrange(len(content) + 1)]


def replace_numbers(content: bytes, chance: random.Random) -> bytes:
    """Puts 0, -1, 1e308, NaN and the like in place of up to four numbers."""
    return _replace_some(content, chance, _NUMBER, HOSTILE_NUMBERS)


def replace_whole_numbers(content: bytes, chance: random.Random) -> bytes:
    """Changes up to four degrees, multiplicities and the like."""
    return _replace_some(content, chance, _WHOLE, (b"0", b"-1", b"1", b"25", b"2147483647", b"9.5"))


def replace_all_numbers(content: bytes, chance: random.Random) -> bytes:
    """Puts one hostile number in place of each tenth number."""
    number = chance.choice(HOSTILE_NUMBERS)
    return _NUMBER.sub(lambda m: number if chance.random() < 0.1 else m.group(), content)


def cross_references(content: bytes, chance: random.Random) -> bytes:
    """Lets up to four references point to another line, to none, or to themselves."""
    known = _REFERENCE.findall(content) or [b"#1"]
    return _replace_some(content, chance, _REFERENCE, (*chance.choices(known, k=4), b"#999999"))


def change_keywords(content: bytes, chance: random.Random) -> bytes:
    """Gives up to three lines the keyword of another line."""
    known = _KEYWORD.findall(content) or [b"FACE"]
    return _replace_some(content, chance, _KEYWORD, tuple(chance.choices(known, k=3)))


def change_texts(content: bytes, chance: random.Random) -> bytes:
    """Puts hostile names in place of up to four texts."""
    return _replace_some(content, chance, _TEXT, _HOSTILE_TEXTS)


def insert_junk(content: bytes, chance: random.Random) -> bytes:
    """Puts random bytes somewhere."""
    place = chance.randrange(len(content) + 1)
    return content[:place] + chance.randbytes(chance.randint(1, 200)) + content[place:]


MUTATIONS: Final[tuple[Mutation, ...]] = (
    flip_bytes,
    drop_lines,
    repeat_lines,
    cut_off,
    replace_numbers,
    replace_whole_numbers,
    replace_all_numbers,
    cross_references,
    change_keywords,
    change_texts,
    insert_junk,
)


def mutate(content: bytes, chance: random.Random) -> bytes:
    """Applies one to three mutations."""
    for _ in range(chance.randint(1, 3)):
        content = chance.choice(MUTATIONS)(content, chance)
    return content


def _replace_some(
    content: bytes, chance: random.Random, pattern: re.Pattern[bytes], values: tuple[bytes, ...]
) -> bytes:
    places = [match.span() for match in pattern.finditer(content)]
    chosen = chance.sample(places, min(len(places), chance.randint(1, 4)))
    for start, end in sorted(chosen, reverse=True):
        content = content[:start] + chance.choice(values) + content[end:]
    return content
