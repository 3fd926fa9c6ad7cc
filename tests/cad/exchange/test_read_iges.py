"""Names, levels and groups of IGES files tell the roles; damaged files end in a sentence."""

from __future__ import annotations

import contextlib
import random
from pathlib import Path

import pytest

from tests.seeds import seeds
from wrinkle_cad.cad.exchange.choose import Chosen, choose_inputs
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.errors import InputError

from .iges_texts import Entity, iges_text, level_name, line, name_property

LENGTHS = {"P": 50.0, "Q": 60.0, "axis": 70.0}
ORDERS = [["P", "Q"], ["Q", "P"], ["axis", "Q", "P"]]


def chosen_in(folder: Path, entities: list[Entity], **options: str) -> Chosen:
    path = folder / "shoe.igs"
    path.write_text(iges_text(entities, **options))
    return choose_inputs(read_cad(path))


def roles_in(folder: Path, entities: list[Entity], **options: str) -> list[tuple[float, float]]:
    strips = chosen_in(folder, entities, **options).strips
    return sorted((round(strip.p.measure, 6), round(strip.q.measure, 6)) for strip in strips)


def by_label(names: list[str]) -> list[Entity]:
    return [line(LENGTHS[name], LENGTHS[name], label=name) for name in names]


def by_name(names: list[str]) -> list[Entity]:
    count = len(names)
    curves = [
        Entity(110, f"0.,{LENGTHS[name]},0.,{LENGTHS[name]},{LENGTHS[name]},0.,0,1,{{{count + i}}}")
        for i, name in enumerate(names)
    ]
    return [*curves, *map(name_property, names)]


def by_level(names: list[str]) -> list[Entity]:
    curves = [line(LENGTHS[name], LENGTHS[name], level=i + 1) for i, name in enumerate(names)]
    return [*curves, *(level_name(i + 1, name) for i, name in enumerate(names))]


def by_group(names: list[str]) -> list[Entity]:
    curves = [line(LENGTHS[name], LENGTHS[name]) for name in names]
    groups = [
        Entity(402, f"1,{{{i}}}", form=7, label=name, status="00000300")
        for i, name in enumerate(names)
    ]
    return [*curves, *groups]


def by_pieces_on_levels(names: list[str]) -> list[Entity]:
    """Each rail is two lines on one level."""
    halves = [
        Entity(
            110,
            f"{LENGTHS[name] / 2 * k},{LENGTHS[name]},0.,{LENGTHS[name] / 2 * (k + 1)},"
            f"{LENGTHS[name]},0.",
            level=i + 1,
        )
        for k in (1, 0)
        for i, name in enumerate(names)
    ]
    return [*halves, *(level_name(i + 1, name) for i, name in enumerate(names))]


@pytest.mark.parametrize("separators", [{}, {"separator": "/", "end": "!"}])
@pytest.mark.parametrize("names", ORDERS)
@pytest.mark.parametrize("structure", [by_label, by_name, by_level, by_group, by_pieces_on_levels])
def test_roles_go_by_name_whatever_carries_it(
    tmp_path: Path, structure, names: list[str], separators: dict[str, str]
) -> None:
    assert roles_in(tmp_path, structure(names), **separators) == [(50.0, 60.0)]


def test_levels_of_two_strips_hold_their_rails(tmp_path: Path) -> None:
    curves = [
        line(LENGTHS[name] + 100.0 * level, LENGTHS[name] + 9 * level, level=level, label=name)
        for level in (2, 1)
        for name in ("Q", "P")
    ]
    entities = [*curves, level_name(1, "toe"), level_name(2, "heel")]
    strips = chosen_in(tmp_path, entities).strips
    assert {strip.name: strip.p.measure for strip in strips} == {"toe": 150.0, "heel": 250.0}


def test_what_is_blanked_is_no_candidate_unless_it_is_named(tmp_path: Path) -> None:
    shown = [line(LENGTHS[name], LENGTHS[name]) for name in ("P", "Q")]
    hidden = line(70.0, 70.0, status="01000000")
    assert roles_in(tmp_path, [hidden, *shown]) == [(50.0, 60.0)]
    named = [line(70.0, 70.0, status="01000000", label="P"), line(60.0, 60.0, label="Q")]
    assert roles_in(tmp_path, [*named, line(9.0, 1.0)]) == [(70.0, 60.0)]


def plane_face(x: float, level: int) -> list[Entity]:
    """A B-spline surface of 10 x 10 at x, on a level."""
    poles = ",".join(f"{x + 10 * i}.,{10 * j}.,0." for j in range(2) for i in range(2))
    knots = "0.,0.,1.,1.,0.,0.,1.,1."
    parameters = f"1,1,1,1,0,0,1,0,0,{knots},1.,1.,1.,1.,{poles},0.,1.,0.,1."
    return [Entity(128, parameters, level=level)]


def test_all_faces_on_a_level_called_upper_are_the_upper(tmp_path: Path) -> None:
    faces = [face for x in (0, 10, 20) for face in plane_face(x, 5)]
    entities = [*by_label(["Q", "P"]), *faces, *plane_face(90, 6), level_name(5, "upper")]
    upper = chosen_in(tmp_path, entities).upper
    assert upper is not None
    assert (upper.kind, upper.measure) == ("compound", pytest.approx(300.0))


RAILS = by_label(["Q", "P"])
NURBS = "1.,1.,1.,1.,0.,0.,0.,9.,0.,0.,0.,1.,0.,0.,1."
DAMAGED = {
    "a pointer to nothing": (
        [*RAILS, Entity(102, "2,1,901")],
        "entity 102 at directory entry 5 points at 901, which the file does not have",
    ),
    "a count that its list does not have": (
        [*RAILS, Entity(102, "9,1,3")],
        "entity 102 at directory entry 5 has 3 numbers of 10",
    ),
    "too few numbers": (
        [*RAILS, Entity(110, "0.,0.,0.,1.")],
        "entity 110 at directory entry 5 has 4 numbers of 6",
    ),
    "a number beyond all sizes": (
        [*RAILS, Entity(110, "0.,0.,0.,1.E300,0.,0.")],
        r"entity 110 at directory entry 5 holds the number 1\.E300",
    ),
    "counts of a spline": (
        [*RAILS, Entity(126, f"5,1,0,0,1,0,0.,0.,1.,1.,{NURBS}")],
        "entity 126 at directory entry 5 has 25 parameters, its counts say 40",
    ),
    "knots that fall": (
        [*RAILS, Entity(126, f"1,1,0,0,1,0,0.,2.,1.,1.,{NURBS}")],
        "entity 126 at directory entry 5 has knots that do not rise",
    ),
    "a degree above its points": (
        [*RAILS, Entity(126, f"1,3,0,0,1,0,0.,0.,1.,1.,{NURBS}")],
        "entity 126 at directory entry 5 has degree 3 and 2 control points",
    ),
    "an entity that holds itself": (
        [*RAILS, Entity(102, "1,5")],
        "the entity at directory entry 5 holds itself",
    ),
    "a matrix that is not there": (
        [*RAILS, Entity(124, "1.,0.,0.,0.,0.,1.,0.,0.,0.,0.,1.")],
        "entity 124 at directory entry 5 has 11 numbers of 12",
    ),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_file_names_the_entity(tmp_path: Path, name: str) -> None:
    entities, message = DAMAGED[name]
    with pytest.raises(InputError, match=f"damaged: {message}. Export it again"):
        chosen_in(tmp_path, entities)


def test_records_out_of_order_and_pointers_past_the_parameters_are_damage(tmp_path: Path) -> None:
    lines = iges_text(RAILS).splitlines(keepends=True)
    at = next(i for i, record in enumerate(lines) if record[72] == "D")
    swapped = [*lines[: at + 1], lines[at + 3], lines[at + 2], lines[at + 1], *lines[at + 4 :]]
    beyond = [lines[i].replace("       1       0", "      99       0", 1) if i == at else lines[i]
              for i in range(len(lines))]  # fmt: skip
    for damaged, message in (
        (swapped, "record 2 of section D is numbered 'D      4'"),
        (beyond, "directory entry 1 points at parameters that the file does not have"),
    ):
        (tmp_path / "a.igs").write_text("".join(damaged))
        with pytest.raises(InputError, match=message):
            read_cad(tmp_path / "a.igs")


@pytest.mark.parametrize("seed", seeds(40, 6))
def test_files_with_changed_digits_end_as_read_or_as_refused(tmp_path: Path, seed: int) -> None:
    chance = random.Random(seed)
    faces = [face for x in (0, 10, 20) for face in plane_face(x, 5)]
    text = list(iges_text([*RAILS, *faces, level_name(5, "upper")]))
    digits = [i for i, letter in enumerate(text) if letter.isdigit()]
    for _ in range(chance.randint(1, 6)):
        text[chance.choice(digits)] = str(chance.randrange(10))
    (tmp_path / "a.igs").write_text("".join(text))
    with contextlib.suppress(InputError):
        assert read_cad(tmp_path / "a.igs").shapes
