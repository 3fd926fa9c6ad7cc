"""Long runs of one thing cost their length: 2 s for 10 MB, whatever they are runs of."""

from __future__ import annotations

import gzip
import time
from pathlib import Path

import pytest

from wrinkle_cad.cad.exchange.sniff import read_source
from wrinkle_cad.cad.exchange.step.links import link_fault
from wrinkle_cad.cad.exchange.step.text import plain_text
from wrinkle_cad.errors import InputError

SIZE = 400_000
"""Bytes; a cost that grows with the square of it would be minutes here."""
SECONDS = 4.0
"""Fifty times what it costs; a busy machine takes its share."""

RUNS = {
    "digits": b"#1=A(" + b"9" * SIZE + b");#2=B(#1);",
    "signs": b"#1=A(" + b"+-" * (SIZE // 2) + b");#2=B(#1);",
    "exponents": b"#1=A(" + b"1E" * (SIZE // 2) + b");#2=B(#1);",
    "line breaks": b"\n" * SIZE,
    "blanks": b" " * SIZE,
    "an id": b"#" + b"1" * SIZE + b"=A();",
    "blanks behind ids": (b"#1" + b"\n" * 50) * (SIZE // 52),
    "comments that do not end": b"/* " * (SIZE // 3),
    "comments": b"/**/" * (SIZE // 4),
    "quotes": b"#1=A(" + b"'" * SIZE + b");",
    "empty statements": b";" * SIZE,
    "empty statements apart": b" ;\n" * (SIZE // 3),
    "empty strings": b"#1=A(" + b", ''" * (SIZE // 4) + b");",
    "parentheses": b"#1=A(" + b"(" * SIZE,
    "sections": b"DATA(" * (SIZE // 5),
    "references": b"#1=A(" + b"#1," * (SIZE // 3) + b"#1);",
    "signs of references": b"#1=A(" + b"#" * SIZE + b");",
    "escapes": b"#1=A('" + rb"\X2\ " * (SIZE // 5) + b"');",
}


@pytest.mark.parametrize("run", RUNS)
def test_a_long_run_costs_its_length(tmp_path: Path, run: str) -> None:
    path = tmp_path / "a.step"
    path.write_bytes(b"ISO-10303-21;\nDATA;\n" + RUNS[run] + b"\nENDSEC;\nEND-ISO-10303-21;\n")
    start = time.process_time()
    link_fault(plain_text(read_source(path).content))
    assert time.process_time() - start < SECONDS


def test_many_small_gzip_members_cost_their_length(tmp_path: Path) -> None:
    path = tmp_path / "a.step"
    path.write_bytes(gzip.compress(b"") * 90_000)
    start = time.process_time()
    with pytest.raises(InputError, match="empty"):
        read_source(path)
    assert time.process_time() - start < SECONDS


def test_more_gzip_members_than_any_tool_writes_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.step"
    path.write_bytes(gzip.compress(b"") * 100_001)
    with pytest.raises(InputError, match="more than 100000 gzip files"):
        read_source(path)


def test_an_id_of_thousands_of_digits_is_a_fault() -> None:
    text = b"#" + b"1" * 5000 + b"=A();\n"
    fault = link_fault(text)
    assert fault is not None
    assert "an id of 5000 digits" in fault
    assert len(fault) < 120
