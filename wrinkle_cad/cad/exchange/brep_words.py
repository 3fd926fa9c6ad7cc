"""The words of a BREP text file, read one after the other, and what is wrong with them.

What is wrong is said as the end of a sentence whose start names the entry.
"""

from __future__ import annotations

from typing import Final

from wrinkle_cad import settings

ENDLESS: Final = 1e101
"""Parameters at which what has no ends begins and ends are written as 1e100 or 2e100."""


class Tokens:
    """The words of the tables, one after the other."""

    def __init__(self, words: list[bytes]) -> None:
        self._words, self._at = words, 0

    def word(self) -> bytes:
        """Returns the next word, and goes behind it; empty at the end."""
        self._at += 1
        return self._words[self._at - 1] if self._at <= len(self._words) else b""

    def next_word(self) -> bytes:
        """Returns the next word; empty at the end."""
        return self._words[self._at] if self._at < len(self._words) else b""

    def whole(self, least: int, most: int) -> int:
        """Returns the next word as a whole number.

        Raises:
            ValueError: it is none, or out of its range.
        """
        word = self.word()
        try:
            number = int(word)
        except ValueError:
            raise ValueError(f"has '{shown(word)}' where a whole number belongs") from None
        if not least <= number <= most or b"_" in word:
            raise ValueError(f"has '{shown(word)}' where a number from {least} to {most} belongs")
        return number

    def reals(self, count: int, most: float = settings.LARGEST_COORDINATE) -> list[float]:
        """Returns the next words as numbers.

        Raises:
            ValueError: there are fewer, one is none, or larger than allowed.
        """
        words = self._words[self._at : self._at + count]
        self._at += count
        if len(words) < count:
            raise ValueError("ends before its numbers do")
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            numbers = []
        # Python takes 1_000 for a number, the kernel takes it for two words.
        is_plain = b"_" not in b"".join(words) and len(numbers) == count
        if is_plain and all(abs(number) <= most for number in numbers):
            return numbers
        wrong = next(word for word in words if not _is_number(word, most))
        raise ValueError(f"has '{shown(wrong)}' where a number of at most {most:g} belongs")


def _is_number(word: bytes, most: float) -> bool:
    try:
        return abs(float(word)) <= most and b"_" not in word
    except ValueError:
        return False


def shown(word: bytes) -> str:
    """Returns a word as a message shows it."""
    return word[:30].decode("ascii", "replace")
