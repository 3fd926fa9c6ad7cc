"""Rails keep the roles that their names give them, whatever carries the name, in any order."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from steputils import p21

from tests.seeds import seeds
from wrinkle_cad.cad.exchange.choose import Chosen, choose_inputs
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.errors import InputError

from .structures import (
    ONE_STRIP,
    ROOT,
    TWO_STRIPS,
    by_assembly,
    by_curve,
    by_instance,
    by_layer,
    by_mapped_item,
    by_set,
    curve,
    placed,
    product,
    step_text,
    two_by_product,
    two_by_set,
    wireframe,
    written,
)

ORDERS = [["P", "Q"], ["Q", "P"], ["axis", "Q", "P"]]
LONG = [(150.0, 160.0)]


def chosen_in(path: Path) -> Chosen:
    return choose_inputs(read_cad(path))


def roles_of(path: Path) -> list[tuple[float, float]]:
    strips = chosen_in(path).strips
    return sorted((round(strip.p.measure, 6), round(strip.q.measure, 6)) for strip in strips)


@pytest.mark.parametrize("seed", seeds(4, 1))
@pytest.mark.parametrize("names", ORDERS)
@pytest.mark.parametrize("structure", ONE_STRIP)
def test_roles_go_by_name_whatever_carries_it(tmp_path: Path, structure, names, seed: int) -> None:
    entities = structure(names)
    random.Random(seed).shuffle(entities)
    assert roles_of(written(tmp_path / "shoe.step", entities)) == [(50.0, 60.0)]


@pytest.mark.parametrize("seed", seeds(4, 1))
@pytest.mark.parametrize("names", ORDERS)
@pytest.mark.parametrize("structure", TWO_STRIPS)
def test_what_holds_one_p_and_one_q_is_a_strip(tmp_path: Path, structure, names, seed: int) -> None:
    entities = structure(names)
    random.Random(seed).shuffle(entities)
    path = written(tmp_path / "shoe.step", entities)
    assert roles_of(path) == [(50.0, 60.0), *LONG]
    assert {strip.name for strip in chosen_in(path).strips} == {"toe", "heel"}


@pytest.mark.parametrize("names", ORDERS)
@pytest.mark.parametrize("structure", [*ONE_STRIP, *TWO_STRIPS])
def test_roles_in_files_that_steputils_wrote(tmp_path: Path, structure, names) -> None:
    file = p21.loads(step_text(structure(names)))
    (section,) = file.data
    order = list(section.instances.items())
    random.Random(len(order)).shuffle(order)
    section.instances.clear()
    section.instances.update(order)
    file.save(tmp_path / "shoe.step")
    assert roles_of(tmp_path / "shoe.step")[0] == (50.0, 60.0)


def test_the_most_specific_name_counts(tmp_path: Path) -> None:
    entities = [
        *by_curve(["Q", "P"]),
        "#80=PRESENTATION_LAYER_ASSIGNMENT('P','',(#100,#110))",
    ]
    assert roles_of(written(tmp_path / "shoe.step", entities)) == [(50.0, 60.0)]


def test_beside_a_curve_called_p_its_layer_does_not_make_others_p(tmp_path: Path) -> None:
    entities = [
        *by_curve(["Q", "P", "axis"]),
        "#80=PRESENTATION_LAYER_ASSIGNMENT('P','',(#110,#120))",
    ]
    assert roles_of(written(tmp_path / "shoe.step", entities)) == [(50.0, 60.0)]


def test_two_candidates_for_one_role_are_both_listed(tmp_path: Path) -> None:
    entities = [*by_layer(["P", "axis"]), "#85=PRESENTATION_LAYER_ASSIGNMENT('P','',(#110))"]
    path = written(tmp_path / "shoe.step", [*entities, *curve(300, 60.0)])
    with pytest.raises(InputError, match=r"\[1\].*50 mm.*\[2\].*70 mm"):
        roles_of(path)
    both = [*ROOT[1:], *by_set(["Q", "P"]), *product(1030, "P", 1020), *curve(1000, 55.0)]
    both += ["#1010=GEOMETRIC_CURVE_SET('',(#1000))", wireframe("#1010", number=1020)]
    with pytest.raises(InputError) as raised:
        roles_of(written(tmp_path / "shoe.step", both))
    assert str(raised.value) == (
        "Cannot choose curves in shoe.step: 2 curves are called 'P': [2] 'P' edge 50 mm, [3] 'P'"
        " edge 55 mm. Join them to one wire, or choose with --p and --q."
    )


def test_each_choice_says_whose_name_it_was(tmp_path: Path) -> None:
    said = {
        structure.__name__: chosen_in(written(tmp_path / "a.step", structure(["Q", "P"]))).reasons
        for structure in (by_curve, by_set, by_layer, by_mapped_item, by_instance, by_assembly)
    }
    assert {name: reasons[0].partition(", ")[2] for name, reasons in said.items()} == {
        "by_curve": "by its name",
        "by_set": "by the name of its set",
        "by_layer": "by the name of its layer",
        "by_mapped_item": "by the name of its instance",
        "by_instance": "by its name",
        "by_assembly": "by the name of what holds it",
    }
    two = chosen_in(written(tmp_path / "a.step", two_by_set(["Q", "P"]))).reasons
    assert two[2] == "P of heel is [4] 'P' edge 150 mm, by its name"


def test_one_rail_of_two_strips_more_than_they_have_is_a_sentence(tmp_path: Path) -> None:
    entities = [*two_by_product(["P", "Q"]), *curve(300, 90.0, "P")]
    entities += ["#310=GEOMETRIC_CURVE_SET('',(#300))", wireframe("#310", number=311)]
    entities.append("#312=SHAPE_REPRESENTATION_RELATIONSHIP('','',#15,#311)")
    with pytest.raises(InputError, match=r"3 curves are called 'P'.*90 mm.*50 mm.*150 mm"):
        roles_of(written(tmp_path / "shoe.step", entities))


def test_one_part_at_two_places_is_two_strips(tmp_path: Path) -> None:
    entities = [*ROOT, *curve(100, 50.0, "P"), *curve(110, 60.0, "Q")]
    entities += ["#90=GEOMETRIC_CURVE_SET('',(#100,#110))", wireframe("#90,#9904", number=91)]
    entities += product(30, "lace", 91)
    for number, name in ((40, ""), (50, "")):
        entities += placed(number, name, child=(32, 91))
    strips = chosen_in(written(tmp_path / "shoe.step", entities)).strips
    assert [strip.name for strip in strips] == ["lace", "lace 2"]


def with_hidden(item: str, *, names: tuple[str, str, str] = ("", "", "")) -> list[str]:
    """Two curves, and a third that is hidden itself or by its set, representation or layer."""
    first, second, third = names
    is_layer = item == "#94"
    return [
        *ROOT, *curve(100, 60.0, first), *curve(110, 50.0, second), *curve(120, 70.0, third),
        "#92=GEOMETRIC_CURVE_SET('',(#100,#110))", wireframe("#92", number=19),
        "#93=GEOMETRIC_CURVE_SET('',(#120))", wireframe("#93", number=20),
        "#95=SHAPE_REPRESENTATION_RELATIONSHIP('','',#15,#19)",
        "#96=SHAPE_REPRESENTATION_RELATIONSHIP('','',#15,#20)",
        "#94=PRESENTATION_LAYER_ASSIGNMENT('help','',(#120))",
        f"#60=INVISIBILITY(({'#94' if is_layer else '#61'}))",
        *([] if is_layer else [f"#61=STYLED_ITEM('',(),{item})"]),
    ]  # fmt: skip


@pytest.mark.parametrize("item", ["#120", "#93", "#20", "#94"])
def test_what_the_file_hides_is_no_candidate_unless_it_is_named(tmp_path: Path, item: str) -> None:
    shown = read_cad(written(tmp_path / "shoe.step", with_hidden(item))).curves()
    assert [round(rail.measure) for rail in shown] == [60, 50]
    named = with_hidden(item, names=("", "P", "Q"))
    assert roles_of(written(tmp_path / "named.step", named)) == [(50.0, 70.0)]


def test_of_two_curves_of_one_name_the_one_that_is_shown_counts(tmp_path: Path) -> None:
    entities = [
        *by_curve(["Q", "P", "axis"]),
        "#60=INVISIBILITY((#61))",
        "#61=STYLED_ITEM('',(),#120)",
    ]
    twice = [entry.replace("'axis'", "'P'") for entry in entities]
    assert roles_of(written(tmp_path / "shoe.step", twice)) == [(50.0, 60.0)]


def test_two_names_without_roles_are_taken_in_their_own_order(tmp_path: Path) -> None:
    for names in (["P", "Q"], ["Q", "P"]):
        entities = [
            entity.replace("'P'", "'Curve 9'").replace("'Q'", "'Curve 10'")
            for entity in by_curve(names)
        ]
        assert roles_of(written(tmp_path / "shoe.step", entities)) == [(50.0, 60.0)]
