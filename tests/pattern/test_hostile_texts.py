"""Names from anywhere never break a file, never leave it, and every change is told."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest

from tests.pattern import strips
from tests.pattern.formats.test_dxf import audit
from tests.pattern.group_codes import read_group_codes
from tests.pattern.strips import make_pieces
from wrinkle_cad.pattern.check.judging import judge_dxf
from wrinkle_cad.pattern.formats.dxf import dxf_file
from wrinkle_cad.pattern.formats.pdf import pdf_file
from wrinkle_cad.pattern.formats.plain_text import LONGEST_TEXT, ascii_name, ascii_text
from wrinkle_cad.pattern.formats.svg import svg_bytes, write_svg
from wrinkle_cad.pattern.piece.options import PieceSettings

HOSTILE = {
    "newline": "vamp\n  0\nENDSEC\n  0\nEOF\n",
    "carriage return": "vamp\r\n  0\r\nEOF",
    "quotes": "\"vamp\" 'left' `x`",
    "long": "x" * 300,
    "japanese": "甲革の型紙",
    "path": "../../x",
    "windows path": "..\\..\\con",
    "formula": "=cmd()|' /C calc'!A0",
    "script": "<script>alert(1)</script>",
    "cdata": "]]><!ENTITY x>",
    "control": "a\0b\x1b[31m\x07c\u202ed",
    "surrogate": "bad \ud800 end",
    "escapes": "%%cvamp \\U+00C4 \\P{\\fArial;x} ^J^M",
    "accents": "Größe Ångström naïve",
    "empty": "",
    "blank": "   \t ",
    "mathtext": "$\\frac{1}{0}$ $$",
    "emoji": "boot 👢",
    "dxf group": "  0\nLINE\n  8\nCUT",
}

RECTANGLE = strips.rectangle()


def pieces_named(text):
    settings = PieceSettings(size=text, material=text, seam_allowance=(3.0,) * 4, hand="left")
    return make_pieces(*RECTANGLE, name=text, settings=settings)


@pytest.mark.parametrize("case", HOSTILE)
@pytest.mark.parametrize("profile", ["cutter", "aama", "astm"])
def test_dxf_files_stay_whole_ascii_and_clean(case, profile, tmp_path):
    text = HOSTILE[case]
    plain = dxf_file(pieces_named("plain"), profile=profile)
    for version in (None, "R2010") if profile == "cutter" else (None,):
        made = dxf_file(pieces_named(text), profile=profile, version=version)
        assert all(byte < 128 for byte in made.content)
        audit(made.content)
        dxf = read_group_codes(made.content)
        values = [value for code, value in dxf.tags if code == 1]
        assert all(len(value) <= 255 for value in values)
        if version is None:
            before = read_group_codes(plain.content)
            kinds = [e.kind for e in dxf.entities if e.kind != "LINE"]
            # Texts beside a piece have a leader.
            assert kinds == [e.kind for e in before.entities if e.kind != "LINE"] or (
                not text.strip()
            )
            assert len(dxf.blocks) == len(before.blocks)
        path = tmp_path / "named.dxf"
        path.write_bytes(made.content)
        assert judge_dxf(path).is_clean, judge_dxf(path).findings


@pytest.mark.parametrize("case", HOSTILE)
def test_what_was_changed_is_reported_and_nothing_else(case):
    text = HOSTILE[case]
    for profile in ("cutter", "aama"):
        findings = dxf_file(pieces_named(text), profile=profile).findings
        changed = ascii_text(text) != text or (profile == "aama" and not text)
        assert ("text-changed" in {finding.code for finding in findings}) == changed
        for finding in findings:
            assert finding.message.isascii()
            assert "\n" not in finding.message


@pytest.mark.parametrize("case", HOSTILE)
def test_svg_files_stay_well_formed_and_hold_no_foreign_element(case, tmp_path):
    content = svg_bytes(pieces_named(HOSTILE[case]))
    root = ET.fromstring(content.decode("utf-8"))
    tags = {element.tag.rsplit("}", 1)[-1] for element in root.iter()}
    assert tags <= {"svg", "title", "g", "polygon", "polyline", "path", "text", "circle"}
    findings = write_svg(tmp_path / "a.svg", pieces_named(HOSTILE[case]))
    told = any(finding.code == "text-changed" for finding in findings)
    assert told == any(
        " ".join(text.split()) != text or not text.isprintable()
        for piece in pieces_named(HOSTILE[case])
        for text in piece.texts
    ) or case in ("control", "emoji")


@pytest.mark.parametrize("case", ["newline", "long", "japanese", "control", "mathtext"])
def test_pdf_files_are_written_whatever_the_name(case):
    made = pdf_file(pieces_named(HOSTILE[case]))
    assert made.content.startswith(b"%PDF")
    assert made.content.rstrip().endswith(b"%%EOF")


def test_letters_lose_their_accents_or_are_spelled_out():
    assert ascii_text("Größe Ångström naïve Łódź Æsir ø") == "Grosse Angstrom naive Lodz AEsir o"
    assert ascii_text("甲革") == "??"
    assert ascii_text("a\u0301b\u200bc") == "abc"
    assert ascii_text("\u00bd \u00d7 3 mm \u2013 \u201cx\u201d") == '1/2 x 3 mm - "x"'


def test_texts_are_one_line_without_escapes_and_not_too_long():
    assert ascii_text("a\nb\t c\r\n") == "a b c"
    assert ascii_text("%%c \\P ^J") == "% %c /P J"
    assert len(ascii_text("x" * 999)) == LONGEST_TEXT
    assert ascii_text("plain (1) = ok!") == "plain (1) = ok!"


def test_names_fit_r12_symbol_tables():
    assert ascii_name("../../x", longest=20) == "X"
    assert ascii_name("vamp, left (38)", longest=20) == "VAMP_LEFT_38"
    assert ascii_name("甲革", longest=20) == "PIECE"
    assert ascii_name("a" * 40, longest=20) == "A" * 20
