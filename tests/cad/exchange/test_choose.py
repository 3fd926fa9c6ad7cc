"""Which shapes are P, Q and the upper: by name, by index, or as the only candidates."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cad.makers import arc, box
from wrinkle_cad.cad.exchange.choose import Chosen, choose_inputs
from wrinkle_cad.cad.exchange.shapes import CadFile, NamedShape
from wrinkle_cad.cad.kernel.topology import make_vertex
from wrinkle_cad.errors import InputError


def file_of(*shapes: tuple[str, str], is_compressed: bool = False) -> CadFile:
    """A file of (name, kind) shapes whose measures are their indices times ten."""
    made = {"edge": arc(0.0), "vertex": make_vertex((0.0, 0.0, 0.0))}
    listed = tuple(
        NamedShape(name, i, kind, made.get(kind, box()), 0.0 if kind == "vertex" else 10.0 * i)
        for i, (name, kind) in enumerate(shapes, 1)
    )
    return CadFile(Path("a.step"), "STEP", "mm", listed, is_compressed)


def indices(chosen: Chosen) -> list[tuple[str, int, int]]:
    return [(strip.name, strip.p.index, strip.q.index) for strip in chosen.strips]


def failure(cad_file: CadFile, **choice: str) -> str:
    with pytest.raises(InputError) as caught:
        choose_inputs(cad_file, **choice)
    message = str(caught.value)
    assert "\n" not in message
    assert "a.step" in message
    return message


def test_p_q_and_upper_are_found_by_name_in_any_order() -> None:
    chosen = choose_inputs(
        file_of(("Q", "wire"), ("x", "edge"), ("upper", "shell"), ("P", "edge"), ("y", "face"))
    )
    assert indices(chosen) == [("strip", 4, 1)]
    assert chosen.upper is not None
    assert chosen.upper.index == 3
    assert any("by its name" in reason for reason in chosen.reasons)


def test_several_strips_are_found_in_the_order_of_the_file() -> None:
    chosen = choose_inputs(
        file_of(("toe cap:P", "edge"), ("a:b:Q", "edge"), ("toe cap:Q", "edge"), ("a:b:P", "edge"))
    )
    assert indices(chosen) == [("toe cap", 1, 3), ("a:b", 4, 2)]
    assert chosen.upper is None


def test_an_exact_name_beats_one_in_another_case() -> None:
    both = file_of(("p", "edge"), ("P", "edge"), ("q", "edge"), ("UPPER", "face"))
    chosen = choose_inputs(both)
    assert indices(chosen) == [("strip", 2, 3)]
    assert chosen.upper is not None
    assert chosen.upper.name == "UPPER"
    split = file_of(("Toe:P", "edge"), ("toe:q", "edge"))
    assert indices(choose_inputs(split)) == [("Toe", 1, 2)]
    two = file_of(("T:P", "edge"), ("t:P", "edge"), ("T:Q", "edge"), ("t:Q", "edge"))
    assert indices(choose_inputs(two)) == [("T", 1, 3), ("t", 2, 4)]


def test_without_names_two_curves_and_one_surface_are_taken() -> None:
    chosen = choose_inputs(
        file_of(("Sketch", "wire"), ("", "shell"), ("", "edge"), ("pin", "vertex"), ("b", "solid"))
    )
    assert indices(chosen) == [("strip", 1, 3)]
    assert chosen.upper is not None
    assert chosen.upper.index == 2
    assert len(chosen.reasons) == 3


def test_a_solid_is_an_upper_only_when_chosen() -> None:
    cad_file = file_of(("", "edge"), ("", "edge"), ("block", "solid"))
    assert choose_inputs(cad_file).upper is None
    chosen = choose_inputs(cad_file, upper="block").upper
    assert chosen is not None
    assert chosen.kind == "solid"


FOUR = file_of(("", "edge"), ("rim", "edge"), ("Rim", "edge"), ("4", "edge"), ("rim", "face"))


@pytest.mark.parametrize(
    ("p", "q", "expected"),
    [
        ("1", "3", (1, 3)),
        ("[2]", " 1 ", (2, 1)),
        ("rim", "RIM", None),
        ("rim", "Rim", (2, 3)),
        ("4", "1", (4, 1)),
    ],
)
def test_curves_are_chosen_by_name_or_index(
    p: str, q: str, expected: tuple[int, int] | None
) -> None:
    if expected is None:
        assert "means 2 shapes" in failure(FOUR, p=p, q=q)
    else:
        assert indices(choose_inputs(FOUR, p=p, q=q)) == [("strip", *expected)]


def test_a_name_of_digits_beats_an_index() -> None:
    cad_file = file_of(("2", "edge"), ("x", "edge"), ("y", "edge"))
    assert indices(choose_inputs(cad_file, p="2", q="3")) == [("strip", 1, 3)]


def test_one_chosen_rail_finds_its_counterpart() -> None:
    named = file_of(("a:P", "edge"), ("a:Q", "edge"), ("b:P", "edge"), ("b:Q", "edge"))
    assert indices(choose_inputs(named, p="b:P")) == [("b", 3, 4)]
    assert indices(choose_inputs(file_of(("", "edge"), ("", "edge")), q="1")) == [("strip", 2, 1)]
    assert "Q could be [2] edge 20 mm, [3]" in failure(file_of(*[("", "edge")] * 3), p="1")


@pytest.mark.parametrize(
    ("cad_file", "choice", "cause"),
    [
        (file_of(("", "solid")), {}, "no curves: the file holds only 1 solid"),
        (file_of(("", "face"), ("", "face")), {}, "no curves: the file holds only 2 faces"),
        (file_of(*[("", "vertex")] * 16), {}, "no curves: the file holds only 16 vertices,"),
        (file_of(("", "face"), is_compressed=True), {}, "gzip-compressed"),
        (file_of(("", "edge")), {}, "only one curve: [1] edge 10 mm"),
        (
            file_of(("", "edge"), ("rim", "wire"), ("", "edge")),
            {},
            "3 free curves and none is called P or Q: [1] edge 10 mm, [2] 'rim' wire 20 mm",
        ),
        (file_of(("P", "edge"), ("x", "edge")), {}, "no curve is called 'Q'"),
        (file_of(("t:Q", "edge"), ("x", "edge")), {}, "no curve is called 't:P'"),
        (file_of(("P", "edge"), ("P", "edge"), ("Q", "edge")), {}, "2 curves are called 'P'"),
        (
            file_of(("", "edge"), ("", "edge"), ("", "face"), ("", "shell")),
            {},
            "2 shapes could be the upper: [3] face 30 mm2, [4] shell 40 mm2",
        ),
        (
            file_of(("P", "edge"), ("Q", "edge"), ("upper", "face"), ("upper", "shell")),
            {},
            "2 shapes could be the upper",
        ),
        (FOUR, {"p": "1", "q": "1"}, "both choose"),
        (FOUR, {"p": "1", "q": "nothing"}, "neither a name nor an index; found [1] edge 10 mm"),
        (FOUR, {"p": "1", "q": "99"}, "neither a name nor an index"),
        (FOUR, {"p": "1", "q": ""}, "neither a name nor an index"),
        (FOUR, {"p": "1", "q": "5"}, "a rail is an edge or a wire"),
        (FOUR, {"p": "1", "q": "2", "upper": "3"}, "an upper has faces"),
        (file_of(*[("", "edge")] * 40), {}, "and 28 more"),
    ],
)
def test_whatever_is_not_clear_is_an_error_that_lists_the_candidates(
    cad_file: CadFile, choice: dict[str, str], cause: str
) -> None:
    assert cause in failure(cad_file, **choice)


def test_with_names_an_unnamed_surface_is_no_upper() -> None:
    chosen = choose_inputs(file_of(("P", "edge"), ("Q", "edge"), ("", "face")))
    assert chosen.upper is None
    assert "no shape is called 'upper'" in chosen.reasons[-1]
