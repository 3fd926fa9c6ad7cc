"""The text of a STEP file: line ends, letters, statements, units and counts."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cad.makers import HEAD, TAIL, UNITS, curves_text
from wrinkle_cad.cad.exchange.sniff import STEP, Source
from wrinkle_cad.cad.exchange.step.names import decoded
from wrinkle_cad.cad.exchange.step.text import (
    check_step,
    entities,
    length_units,
    plain_text,
    statements,
    why_no_shape,
)
from wrinkle_cad.errors import InputError


def check(text: str) -> None:
    check_step(Source(Path("a.step"), STEP, text.encode(), False), text.encode())


@pytest.mark.parametrize("line_end", ["\n", "\r\n", "\r"])
def test_line_ends_become_line_feeds(line_end: str) -> None:
    assert plain_text(f"a;{line_end}b;".encode()) == b"a;\nb;"


def test_letters_become_utf_8_whether_they_were_or_not() -> None:
    assert plain_text("Schäfte 靴".encode()).decode() == "Schäfte 靴"
    assert plain_text("Schäfte".encode("latin-1")).decode() == "Schäfte"


def test_apostrophes_that_look_like_ends_are_written_another_way() -> None:
    assert plain_text(b"#1=A('x'')y','z'' ,','',('')) ;") == (
        rb"#1=A('x\X\27)y','z\X\27 ,','',('')) ;"
    )


def test_semicolons_in_strings_and_comments_end_no_statement() -> None:
    text = b"#1=A('x;''y');/* b; */#2=B(\n'/*',#1);"
    assert [b"".join(found.split()) for found in statements(text)] == [b"#1=A('')", b"#2=B('',#1)"]


def test_entities_are_found_by_keyword_only_outside_of_strings() -> None:
    text = b"#1=LINE('');#2=PLANE('LINE(');#3=POLYLINE('');"
    assert list(entities(text, b"LINE")) == [1]


@pytest.mark.parametrize("unit", UNITS)
def test_the_declared_unit_is_found(unit: str) -> None:
    assert length_units(curves_text(unit).encode()) == (unit,)


def test_a_file_without_a_unit_declares_none() -> None:
    assert length_units(curves_text(None).encode()) == ()


def test_a_unit_that_no_geometry_uses_is_not_declared() -> None:
    unused = "#900=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n"
    text = curves_text("mm").replace("DATA;\n", "DATA;\n" + unused)
    assert length_units(text.encode()) == ("mm",)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_a_file_cut_anywhere_is_called_truncated(share: float) -> None:
    text = curves_text()
    with pytest.raises(InputError, match="truncated"):
        check(text[: int(share * len(text))])


def test_a_whole_file_passes() -> None:
    check(curves_text())
    check(curves_text() + "\n\n/* made by */\n")


CURVE = "#20=B_SPLINE_CURVE_WITH_KNOTS('',1,(#1,#2),.UNSPECIFIED.,.F.,.F.,{},.UNSPECIFIED.);\n"
RATIONAL = (
    "#20=(BOUNDED_CURVE()B_SPLINE_CURVE(1,(#1,#2),.UNSPECIFIED.,.F.,.F.)"
    "B_SPLINE_CURVE_WITH_KNOTS((2,2),(0.,1.),.UNSPECIFIED.)CURVE()"
    "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE({})REPRESENTATION_ITEM('c'));\n"
)
SURFACE = (
    "#20=(BOUNDED_SURFACE()B_SPLINE_SURFACE(1,1,((#1,#2),(#3,#4{extra})),.UNSPECIFIED.,.F.,.F.,.F.)"
    "B_SPLINE_SURFACE_WITH_KNOTS((2,2),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)"
    "GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE({weights})"
    "REPRESENTATION_ITEM('s')SURFACE());\n"
)


@pytest.mark.parametrize(
    ("entity", "fault"),
    [
        (CURVE.format("(2,2),(0.,1.,2.)"), "3 knots and 2 multiplicities"),
        (RATIONAL.format("(1.,1.,1.)"), "3 weights for 2 control points"),
        (RATIONAL.format("(1.)"), "1 weights for 2 control points"),
        (SURFACE.format(extra="", weights="((1.,1.),(1.))"), "3 weights for 4 control points"),
        (SURFACE.format(extra=",#5", weights="((1.,1.),(1.,1.))"), "rows of 2 to 3"),
    ],
)
def test_counts_that_contradict_each_other_are_named(entity: str, fault: str) -> None:
    with pytest.raises(InputError, match=f"#20 has {fault}"):
        check(HEAD + entity + TAIL)


@pytest.mark.parametrize(
    "entity",
    [
        CURVE.format("(2,2),(0.,1.)"),
        RATIONAL.format("(1.,2.)"),
        SURFACE.format(extra="", weights="((1.,1.),(1.,1.))"),
    ],
)
def test_counts_that_agree_pass(entity: str) -> None:
    check(HEAD + entity + TAIL)


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        ("#1=DOCUMENT_FILE('a.stp','','',#2,'',$);\n", "external references"),
        ("#1=TRIANGULATED_FACE('',#2,3,(),$,(),());\n", "tessellation"),
        ("#1=FEA_MODEL_3D('',(),$,$,$);\n", "AP209"),
        ("#1=LINE('',#2,#3);\n", "1 curves and faces belong to no shape"),
        ("#1=PRODUCT('','','',());\n", "no curve, face or solid"),
    ],
)
def test_why_a_file_has_no_shape(data: str, cause: str) -> None:
    assert cause in why_no_shape((HEAD + data + TAIL).encode())


@pytest.mark.parametrize(
    ("raw", "text"),
    [
        (rb"\X2\9774\X0\ 1", "靴 1"),
        (rb"\X4\0001F45E\X0\x", "👞x"),
        (rb"\X\E4\S\d", "ää"),
        (rb"it''s \\ here", "it's \\ here"),
        ("靴".encode(), "靴"),
    ],
)
def test_strings_are_decoded(raw: bytes, text: str) -> None:
    assert decoded(raw) == text
