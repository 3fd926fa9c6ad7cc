"""Names that are safe on every system."""

from __future__ import annotations

from pathlib import PurePosixPath

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wrinkle_cad.errors import JobError
from wrinkle_cad.files.names import (
    LONGEST_NAME,
    apply_mask,
    check_mask,
    collision_key,
    error_words,
    one_line,
    printable,
    safe_folder,
    safe_name,
    split_name,
)

HOSTILE = (
    "../../x",
    "/etc/passwd",
    "C:\\Windows\\x",
    "CON",
    "nul",
    "com1.x",
    "LPT²",
    "a" * 300,
    "靴" * 300,
    "a\nb\tc\x00d\x1b[31m",
    "\u202egpj.exe",
    "x\udcff",
    "..",
    ".",
    "",
    "   ",
    "name. . .",
    ".hidden",
    'a<b>c:"d"|e?f*',
)


@pytest.mark.parametrize("text", HOSTILE)
def test_a_hostile_name_becomes_one_plain_component(text: str) -> None:
    assert_is_safe(safe_name(text))


@given(st.text(st.characters(exclude_categories=()), max_size=400))
def test_any_text_becomes_a_safe_name_that_stays_as_it_is(text: str) -> None:
    name = safe_name(text)
    assert_is_safe(name)
    assert safe_name(name) == name


@pytest.mark.parametrize("text", ["vamp", "vamp strip.v2", "靴-左", "Größe 42", "console", "COM10"])
def test_a_safe_name_is_left_alone(text: str) -> None:
    assert safe_name(text) == text


def test_long_names_that_differ_at_the_end_stay_apart() -> None:
    assert safe_name("a" * 300 + "1") != safe_name("a" * 300 + "2")


def test_no_part_of_a_folder_leads_out_of_it() -> None:
    folder = safe_folder(PurePosixPath("/a/../b/./CON/c "))
    assert not folder.is_absolute()
    for part in folder.parts:
        assert_is_safe(part)


def test_a_mask_is_filled_in_and_made_safe() -> None:
    name = apply_mask(
        "{number}_{folder}_{stem}.{suffix}",
        stem="va/mp",
        suffix="stp.gz",
        folder=PurePosixPath("left/42"),
        number=7,
    )
    assert name == "0007_left-42_va_mp.stp.gz"


def test_a_mask_may_hold_braces_of_its_own() -> None:
    name = apply_mask("{{x}}{stem}", stem="a", suffix="", folder=PurePosixPath(), number=1)
    assert name == "{x}a"


@pytest.mark.parametrize(
    ("mask", "complaint"),
    [
        ("{stem", "fields stand in braces"),
        ("{size}", "has no field 'size'"),
        ("{stem.__class__}", "has no field"),
        ("{0}", "has no field"),
        ("{}", "has no field"),
        ("all", "the same for every file"),
    ],
)
def test_a_broken_mask_is_refused(mask: str, complaint: str) -> None:
    with pytest.raises(JobError, match=complaint):
        check_mask(mask)


@pytest.mark.parametrize(
    ("first", "second"), [("A/Vamp", "a/vamp"), ("stra\u00dfe", "STRASSE"), ("e\u0301", "\u00e9")]
)
def test_names_that_some_disk_takes_for_the_same_collide(first: str, second: str) -> None:
    assert collision_key(PurePosixPath(first)) == collision_key(PurePosixPath(second))


def test_names_that_every_disk_tells_apart_do_not_collide() -> None:
    assert collision_key(PurePosixPath("a/b")) != collision_key(PurePosixPath("a-b"))


def test_a_printable_text_is_one_line_of_real_characters() -> None:
    text = printable("a\nb\udcff\x1b[31m\u202e\u2028靴")
    assert text == "a\\nb\\udcff\\x1b[31m\\u202e\\u2028靴"
    text.encode("utf-8")


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("a.step", ("a", "step")),
        ("a.b.STP", ("a.b", "STP")),
        ("a.stp.gz", ("a", "stp.gz")),
        (".step", (".step", "")),
        ("a.dat", ("a.dat", "")),
        ("a.dat.gz", ("a.dat", "gz")),
    ],
)
def test_a_name_is_split_into_stem_and_suffixes(name: str, expected: tuple[str, str]) -> None:
    assert split_name(name) == expected


def test_a_line_from_a_file_has_blanks_for_what_is_no_text() -> None:
    assert one_line("a\nb\udcff\x1b[31m\u202e\u2028\ufffe靴") == "a b  [31m   靴"
    assert one_line("two  words, ça va") == "two  words, ça va"


def test_what_an_error_says_is_one_line() -> None:
    assert error_words(ValueError(" no\n such\tthing ")) == "no such thing"
    assert error_words(RuntimeError()) == "RuntimeError"


def assert_is_safe(name: str) -> None:
    assert name not in ("", ".", "..")
    assert not set(name) & set('<>:"/\\|?*')
    assert name.isprintable() or " " in name or any(ord(c) > 127 for c in name)
    assert not any(ord(c) < 32 or 0xD800 <= ord(c) < 0xE000 for c in name)
    assert not name.startswith((".", " "))
    assert not name.endswith((".", " "))
    assert len(name.encode("utf-8")) <= LONGEST_NAME
    assert name.split(".")[0].upper() not in {"CON", "PRN", "AUX", "NUL", "COM1", "LPT1", "LPT²"}
