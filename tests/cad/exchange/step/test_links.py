"""References in a STEP file are checked before the kernel follows them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.cad.exchange.test_write import parts_of_every_kind
from tests.cad.makers import curves_text
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.step.bytes import Header
from wrinkle_cad.cad.exchange.step.links import link_fault
from wrinkle_cad.cad.exchange.step.text import plain_text
from wrinkle_cad.cad.exchange.write import step_bytes
from wrinkle_cad.errors import InputError


@pytest.fixture(scope="module")
def whole() -> bytes:
    return step_bytes(parts_of_every_kind(), Header("a.step"))


def test_whole_files_have_no_fault(whole: bytes) -> None:
    assert link_fault(whole) is None
    assert link_fault(curves_text("inch").encode()) is None


def test_each_missing_entity_that_is_referred_to_is_a_fault(whole: bytes) -> None:
    entities = re.findall(rb"#(\d+) = [^;]*;\n", whole)
    for number in entities[5::97]:
        without = re.sub(rb"#%s = [^;]*;\n" % number, b"", whole)
        is_used = re.search(rb"#%s\b" % number, without) is not None
        fault = link_fault(without)
        assert (fault is not None) == is_used
        assert fault is None or f"#{number.decode()}, which the file does not have" in fault


@pytest.mark.parametrize(
    ("keyword", "pattern", "other"),
    [
        ("LINE", rb"(LINE\('',#\d+,)#\d+", rb"CARTESIAN_POINT"),
        ("VECTOR", rb"(VECTOR\('',)#\d+", rb"CARTESIAN_POINT"),
        ("VERTEX_POINT", rb"(VERTEX_POINT\('',)#\d+", rb"DIRECTION"),
        ("EDGE_CURVE", rb"(EDGE_CURVE\('',)#\d+", rb"DIRECTION"),
        ("EDGE_CURVE", rb"(EDGE_CURVE\('',#\d+,#\d+,)#\d+", rb"DIRECTION"),
        ("ORIENTED_EDGE", rb"(ORIENTED_EDGE\('',\*,\*,)#\d+", rb"PLANE"),
        ("EDGE_LOOP", rb"(EDGE_LOOP\('',\()#\d+", rb"PLANE"),
        ("FACE_BOUND", rb"(FACE_BOUND\('',)#\d+", rb"PLANE"),
        ("ADVANCED_FACE", rb"(ADVANCED_FACE\('',\()#\d+", rb"DIRECTION"),
        ("ADVANCED_FACE", rb"(ADVANCED_FACE\('',\(#\d+\),)#\d+", rb"DIRECTION"),
        ("PLANE", rb"(PLANE\('',)#\d+", rb"DIRECTION"),
        ("CLOSED_SHELL", rb"(CLOSED_SHELL\('',\()#\d+", rb"DIRECTION"),
    ],
)
def test_a_reference_to_the_wrong_kind_is_a_fault(
    tmp_path: Path, whole: bytes, keyword: str, pattern: bytes, other: bytes
) -> None:
    target = re.search(rb"#(\d+) = %s\(" % other, whole)
    assert target is not None
    crossed, count = re.subn(pattern, rb"\g<1>#%s" % target[1], whole, count=1)
    assert count == 1
    fault = link_fault(crossed)
    assert fault is not None
    assert fault.startswith(keyword)
    assert fault.endswith(f"refers to #{target[1].decode()}, a {other.decode()}")
    (tmp_path / "a.step").write_bytes(crossed)
    with pytest.raises(InputError, match="damaged"):
        read_cad(tmp_path / "a.step")


@pytest.mark.parametrize("number", ["1.E308", "1.0E+999999", "-2e+40", "NaN", "inf"])
def test_a_number_that_no_geometry_has_is_a_fault_where_it_is_used(number: str) -> None:
    text = curves_text().replace("(2.0,0.0,0.)", f"({number},0.,0.)")
    fault = link_fault(text.encode())
    assert fault is not None
    assert fault.endswith(f"holds the number {number}")
    unused = curves_text().replace(
        "ENDSEC;\nEND", f"#99=CARTESIAN_POINT('',({number}));\nENDSEC;\nEND"
    )
    assert link_fault(unused.encode()) is None


@pytest.mark.parametrize("number", ["1.E-999", "6.1E+12", "0.00000000001", "3E5"])
def test_a_small_or_plain_number_is_none(number: str) -> None:
    text = curves_text().replace("(2.0,0.0,0.)", f"({number},0.,0.)")
    assert link_fault(text.encode()) is None


def test_a_string_that_does_not_end_is_a_fault(whole: bytes) -> None:
    fault = link_fault(whole.replace(b"FILE_NAME('", b"FILE_NAME(", 1))
    assert fault is not None
    assert "does not end" in fault


def test_a_reference_that_is_no_number_is_a_fault(whole: bytes) -> None:
    fault = link_fault(re.sub(rb"(VECTOR\('',)#\d+", rb"\g<1>#^9", whole, count=1))
    assert fault is not None
    assert "which the file does not have" in fault


@pytest.mark.realdata
def test_real_files_have_no_fault(realdata: Path) -> None:
    for path in sorted(realdata.glob("*.st*p")):
        assert link_fault(plain_text(path.read_bytes())) is None
