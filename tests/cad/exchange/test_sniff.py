"""What a file is, told from its bytes: every cause has a message of its own."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import pytest

from tests.cad.makers import curves_text
from wrinkle_cad.cad.exchange.sniff import BREP, IGES, STEP, read_source
from wrinkle_cad.errors import InputError

STEP_BYTES = curves_text().encode()
IGES_START = b"x".ljust(72) + b"S0000001\n"


def source_of(folder: Path, content: bytes, name: str = "a.step", **limits: int):
    path = folder / name
    path.write_bytes(content)
    return read_source(path, **limits)


@pytest.mark.parametrize(
    ("content", "form"),
    [
        (STEP_BYTES, STEP),
        (b"\xef\xbb\xbf" + STEP_BYTES, STEP),
        (STEP_BYTES.decode().encode("utf-16"), STEP),
        (b"/* a comment; with ISO */\r\n\r\n" + STEP_BYTES, STEP),
        (b"DBRep_DrawableShape\n\nCASCADE Topology V1, (c) Matra-Datavision\n", BREP),
        (b"CASCADE Topology V3, (c) Open Cascade\n", BREP),
        (IGES_START, IGES),
        (IGES_START.replace(b"\n", b"\r\n"), IGES),
        (IGES_START.replace(b"\n", b"\r"), IGES),
    ],
)
def test_the_format_is_told_from_the_content_not_the_name(
    tmp_path: Path, content: bytes, form: str
) -> None:
    for name in ("a.step", "a.igs", "a"):
        assert source_of(tmp_path, content, name).format == form


def test_a_compressed_file_is_unpacked_whatever_it_is_called(tmp_path: Path) -> None:
    for name in ("a.step", "a.stp.gz", "a.step.gz"):
        source = source_of(tmp_path, gzip.compress(STEP_BYTES), name)
        assert source.content == STEP_BYTES
        assert source.is_compressed
    assert not source_of(tmp_path, STEP_BYTES).is_compressed


def test_a_gzip_file_of_several_members_is_unpacked_whole(tmp_path: Path) -> None:
    half = len(STEP_BYTES) // 2
    packed = gzip.compress(STEP_BYTES[:half]) + gzip.compress(STEP_BYTES[half:])
    assert source_of(tmp_path, packed).content == STEP_BYTES


@pytest.mark.parametrize(
    ("content", "cause"),
    [
        (b"", "the file is empty"),
        (b" \r\n\n", "the file is empty"),
        (gzip.compress(b"", mtime=0), "the file is empty"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n", "git-LFS pointer"),
        (b"content is not STEP", "not a STEP, BREP or IGES file: 19 bytes"),
        (b"PK\x03\x04rest", "ZIP archive"),
        (b"\n<!DOCTYPE html><html>", "web page"),
        (b"%PDF-1.7", "PDF"),
        (b"solid a\nfacet normal 0 0 1", "STL mesh"),
        (b"  0\r\nSECTION\r\n", "DXF drawing"),
        (b"BZh91AY", "compressed, but not by gzip"),
        (b"<?xml version='1.0'?>\n<ns:iso_10303_28>", "part 28"),
        (gzip.compress(STEP_BYTES, mtime=0)[:-20], "cut short"),
        (b"\x1f\x8b\x08\x00damaged beyond repair", "damaged"),
    ],
)
def test_each_unusable_file_has_one_line_with_its_cause(
    tmp_path: Path, content: bytes, cause: str
) -> None:
    with pytest.raises(InputError) as caught:
        source_of(tmp_path, content)
    assert cause in str(caught.value)
    assert "a.step" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_control_characters_of_a_strange_file_do_not_reach_the_message(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        source_of(tmp_path, b"\x1b[31m\x00\x07 red \xff\xfe")
    assert str(caught.value).isprintable()


def test_a_file_above_the_limit_is_refused(tmp_path: Path) -> None:
    assert source_of(tmp_path, STEP_BYTES, size_limit=len(STEP_BYTES)).content == STEP_BYTES
    with pytest.raises(InputError, match="the limit is"):
        source_of(tmp_path, STEP_BYTES, size_limit=len(STEP_BYTES) - 1)


def test_a_small_file_that_unpacks_to_a_huge_one_is_refused(tmp_path: Path) -> None:
    bomb = gzip.compress(STEP_BYTES + b" " * 50_000_000)
    with pytest.raises(InputError, match="unpacked"):
        source_of(tmp_path, bomb, size_limit=1_000_000)


@pytest.mark.parametrize(
    ("name", "cause"),
    [("none.step", "No such file"), (".", "a directory"), ("a\0b", "no file can have")],
)
def test_what_cannot_be_opened_says_why(tmp_path: Path, name: str, cause: str) -> None:
    with pytest.raises(InputError, match=cause):
        read_source(tmp_path / name)


def test_a_pipe_is_refused_and_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(InputError, match="not a regular file"):
        read_source(tmp_path / "pipe")


def test_many_comments_before_something_else_cost_no_time(tmp_path: Path) -> None:
    """A plain pattern would need some 2^300 steps here."""
    with pytest.raises(InputError, match="not a STEP"):
        source_of(tmp_path, b"/* a */ " * 300 + b"SOMETHING ELSE")
