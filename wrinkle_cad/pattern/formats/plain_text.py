"""Texts as 7-bit ASCII on one line: what cutters, DXF R12 and block names can carry.

Letters with accents lose them, a few others are spelled out, anything else becomes ``?``. A name
of which nothing is left falls back to ``PIECE``.
"""

from __future__ import annotations

import re
import unicodedata
from typing import Final

from wrinkle_cad.errors import Finding

LONGEST_TEXT: Final = 250
"""Characters; DXF group values end at 255."""

_SPELLED: Final = {
    "\N{LATIN SMALL LETTER SHARP S}": "ss",
    "\N{LATIN SMALL LETTER AE}": "ae",
    "\N{LATIN CAPITAL LETTER AE}": "AE",
    "\N{LATIN SMALL LETTER O WITH STROKE}": "o",
    "\N{LATIN CAPITAL LETTER O WITH STROKE}": "O",
    "\N{LATIN SMALL LETTER L WITH STROKE}": "l",
    "\N{LATIN CAPITAL LETTER L WITH STROKE}": "L",
    "\N{LATIN SMALL LETTER DOTLESS I}": "i",
    "\N{LATIN SMALL LETTER THORN}": "th",
    "\N{LATIN SMALL LETTER D WITH STROKE}": "d",
    "\N{MULTIPLICATION SIGN}": "x",
    "\N{EN DASH}": "-",
    "\N{EM DASH}": "-",
    "\N{RIGHT SINGLE QUOTATION MARK}": "'",
    "\N{LEFT SINGLE QUOTATION MARK}": "'",
    "\N{RIGHT DOUBLE QUOTATION MARK}": '"',
    "\N{LEFT DOUBLE QUOTATION MARK}": '"',
    "\N{DIAMETER SIGN}": "dia ",
    "\N{DEGREE SIGN}": " deg",
}


def ascii_text(text: str, *, longest: int = LONGEST_TEXT) -> str:
    """Returns ``text`` as one line of printable ASCII without a DXF or MTEXT escape in it."""
    plain = []
    for letter in text:
        spelled = _SPELLED.get(letter)
        if spelled is None:
            spelled = "".join(map(_plain_letter, unicodedata.normalize("NFKD", letter)))
        plain.append(spelled)
    # %% and \U+ are escapes to CAD programs; ^ starts a control character in DXF.
    line = "".join(plain).replace("%%", "% %").replace("\\", "/").replace("^", " ")
    return re.sub(r" {2,}", " ", line).strip()[:longest].strip()


def _plain_letter(letter: str) -> str:
    if " " <= letter <= "~":
        return letter
    if letter == "\N{FRACTION SLASH}":
        return "/"
    if unicodedata.category(letter) in ("Mn", "Cf"):
        return ""
    return " " if letter.isspace() else "?"


def ascii_name(text: str, *, longest: int) -> str:
    """Returns ``text`` as a symbol name that DXF R12 accepts: A-Z, 0-9, ``_``, ``-``, ``$``."""
    name = re.sub(r"[^A-Z0-9_$-]+", "_", ascii_text(text).upper()).strip("_")[:longest].strip("_")
    return name or "PIECE"


def text_changed(what: str, before: str, after: str) -> tuple[Finding, ...]:
    """Returns a finding that says how a text was changed, or none if it was not.

    Args:
        what: whose text it is ("name", "material").
        before: as the user gave it.
        after: as the file has it.
    """
    if before == after:
        return ()
    shown = ascii(before if len(before) <= 60 else before[:57] + "...")
    return (
        Finding(
            "text-changed",
            "info",
            f"The {what} {shown} is not what the file can hold, and was written as {after!a}. "
            "Rename it if that is not clear enough.",
        ),
    )
