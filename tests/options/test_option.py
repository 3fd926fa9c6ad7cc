"""A new option is one field: its checks, its flag and its TOML key follow from it."""

from __future__ import annotations

import argparse
import math
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar, Literal

import pytest

from wrinkle_cad.cli.job_arguments import add_option_arguments
from wrinkle_cad.errors import InputError
from wrinkle_cad.job.job import Job
from wrinkle_cad.options.checking import check_known, check_options
from wrinkle_cad.options.option import option, options_of, values_of

Finish = Literal["matt", "gloss"]

COATS = "a whole number from 1 to 9"
FILM = "a number above 0 and at most 2 mm, or none"
DRY = "2 numbers of at least 0 s, or one for all"


@dataclass(frozen=True, kw_only=True)
class PaintSettings:
    """Stands for a settings class to which somebody adds options."""

    title: ClassVar[str] = "the paint"

    finish: Finish = field(default="matt", metadata=option("how it shines"))
    coats: int = field(default=1, metadata=option("how often", least=1, most=9))
    film: float | None = field(
        default=0.1, metadata=option("of one coat", unit="mm", above=0.0, most=2.0)
    )
    dry: tuple[float, float] | None = field(
        default=None, metadata=option("first, rest", unit="s", least=0.0, is_one_for_all=True)
    )
    spots: tuple[tuple[float, float], ...] = field(
        default=(), metadata=option("where", above=0.0, below=1.0, flag="--spot")
    )
    colors: tuple[Literal["red", "blue"], ...] = field(default=(), metadata=option("which"))
    way: Literal["along", "across"] | tuple[float, float, float] = field(
        default="along", metadata=option("the brush's")
    )
    is_dry: bool = field(default=True, metadata=option("hand it out dry"))
    recipe: Path | None = field(default=None, metadata=option("a file"))
    note: str = "no option"

    def __post_init__(self) -> None:
        check_options(self)


def from_flags(*arguments: str) -> PaintSettings:
    parser = argparse.ArgumentParser(exit_on_error=False)
    add_option_arguments(parser, PaintSettings)
    given = vars(parser.parse_args(arguments))
    return PaintSettings(**{key: value for key, value in given.items() if value is not None})


def from_toml(text: str) -> PaintSettings:
    table = tomllib.loads(text)
    check_known(table, options_of(PaintSettings), "paint.toml")
    return PaintSettings(**table)


def test_a_string_option_has_its_check_its_flag_and_its_key_from_the_field_alone() -> None:
    assert from_flags().finish == from_toml("").finish == PaintSettings().finish == "matt"
    assert from_flags("--finish", "gloss").finish == "gloss"
    assert from_toml('finish = "gloss"').finish == "gloss"
    sentence = r"^finish cannot be 'dull': give matt or gloss\.$"
    with pytest.raises(InputError, match=sentence):
        from_toml('finish = "dull"')
    with pytest.raises(argparse.ArgumentError, match="matt"):
        from_flags("--finish", "dull")
    parser = argparse.ArgumentParser()
    add_option_arguments(parser, PaintSettings)
    shown = " ".join(parser.format_help().split())
    assert "the paint: --finish {matt,gloss} how it shines (matt)" in shown


def test_every_kind_of_option_says_the_same_as_flag_and_as_key() -> None:
    by_flag = from_flags(
        "--coats=2", "--film=none", "--dry=5", "--spot=0.5,0.25", "--spot=0.1,0.2",
        "--colors=red,blue", "--way=1,0,0", "--no-is-dry", "--recipe=a.toml",
    )  # fmt: skip
    by_key = from_toml(
        'coats = 2\nfilm = "none"\ndry = 5\nspots = [[0.5, 0.25], [0.1, 0.2]]\n'
        'colors = ["red", "blue"]\nway = [1, 0, 0]\nis_dry = false\nrecipe = "a.toml"\n'
    )
    assert by_flag == by_key
    assert by_key.film is None
    assert by_key.dry == (5.0, 5.0)
    assert by_key.way == (1.0, 0.0, 0.0)
    assert from_flags("--way", "across").way == "across"


def test_only_fields_with_metadata_are_options() -> None:
    assert "note" not in options_of(PaintSettings)
    assert set(values_of(PaintSettings(), PaintSettings)) == set(options_of(PaintSettings))
    with pytest.raises(
        InputError, match=r"^paint\.toml has no option 'finsh': did you mean finish"
    ):
        from_toml('finsh = "matt"')
    with pytest.raises(InputError, match="give coats, colors, "):
        from_toml("xyzzy = 1")


@pytest.mark.parametrize(
    ("wrong", "found", "give"),
    [
        ({"coats": 0}, "0", COATS),
        ({"coats": 1.5}, "1.5", COATS),
        ({"coats": True}, "True", COATS),
        ({"coats": 10**400}, "a number of 401 digits", COATS),
        ({"film": 10**400}, "a number of 401 digits mm", FILM),
        ({"film": 0}, "0 mm", FILM),
        ({"film": math.nan}, "nan mm", FILM),
        ({"film": "thin"}, "'thin'", FILM),
        ({"dry": (1, 2, 3)}, "(1, 2, 3)", DRY),
        ({"dry": (1, math.inf)}, "(1, inf)", DRY),
        ({"spots": [[0.5, 1]]}, "((0.5, 1))", "a list of 2 numbers above 0 and below 1"),
        ({"colors": ["green"]}, "('green')", "a list of red or blue"),
        ({"way": "up"}, "'up'", "along, across or 3 numbers"),
        ({"is_dry": "yes"}, "'yes'", "true or false"),
        ({"recipe": 5}, "5", "a path"),
        ({"recipe": "a\0b"}, "'a\\x00b'", "a path"),
        ({"finish": "x\n" * 100}, "'x\\nx\\nx", "matt or gloss"),
    ],
)
def test_a_value_that_an_option_cannot_have_is_one_short_sentence(
    wrong: dict[str, object], found: str, give: str
) -> None:
    with pytest.raises(InputError) as caught:
        PaintSettings(**wrong)  # type: ignore[arg-type]
    (name,) = wrong
    said = str(caught.value)
    assert said.startswith(f"{name} cannot be {found}")
    assert said.endswith(f": give {give}.")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 160


def _numeric(owner: type) -> list[str]:
    return [
        name
        for name, setting in options_of(owner).items()
        if setting.kind.base in (int, float)
        or (setting.kind.part is not None and setting.kind.part.base in (int, float))
    ]


@pytest.mark.parametrize("name", _numeric(Job))
def test_every_numeric_option_of_a_job_has_a_range_that_both_its_ends_keep(name: str) -> None:
    setting = options_of(Job)[name]
    assert math.isfinite(setting.option.least)
    assert math.isfinite(setting.option.most)
    for value in (1e300, -1e300, math.nan, math.inf, 10**400, -(10**5000), 1e-300):
        many = [value] * (setting.kind.count or 1)
        given = value if setting.kind.part is None else many
        allowed = value == 1e-300 and setting.kind.base is not int and setting.option.least <= 0.0
        if allowed:
            continue
        with pytest.raises(InputError, match=rf"^{name} cannot be ") as caught:
            Job(input=Path("x.step"), **{name: given})  # type: ignore[arg-type]
        assert len(str(caught.value)) < 200
