"""Rails keep the roles that their names give them, whatever carries the name, in any order."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from OCP.Interface import Interface_Static
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.XCAFDoc import XCAFDoc_DocumentTool

from tests.cad.makers import HEAD, PRODUCT, TAIL, UNITS, box, line
from wrinkle_cad.cad.exchange.choose import choose_inputs
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.xde import kernel_parameters, new_document, set_name, silence_kernel
from wrinkle_cad.cad.kernel.topology import faces_of
from wrinkle_cad.errors import InputError

LENGTHS = {"P": 50.0, "Q": 60.0, "axis": 70.0}


def curve(base: int, length: float, name: str = "") -> list[str]:
    return [
        f"#{base}=B_SPLINE_CURVE_WITH_KNOTS('{name}',1,(#{base + 1},#{base + 2}),"
        ".UNSPECIFIED.,.F.,.F.,(2,2),(0.,1.),.UNSPECIFIED.)",
        f"#{base + 1}=CARTESIAN_POINT('',(0.,{base}.,0.))",
        f"#{base + 2}=CARTESIAN_POINT('',({length},{base}.,0.))",
    ]


def edge(base: int, length: float, name: str = "") -> list[str]:
    return [
        f"#{base + 3}=EDGE_CURVE('{name}',#{base + 4},#{base + 5},#{base},.T.)",
        f"#{base + 4}=VERTEX_POINT('',#{base + 1})",
        f"#{base + 5}=VERTEX_POINT('',#{base + 2})",
        *curve(base, length),
    ]


def wireframe(
    items: str, *, kind: str = "GEOMETRICALLY_BOUNDED_WIREFRAME", number: int = 15
) -> str:
    return f"#{number}={kind}_SHAPE_REPRESENTATION('',({items}),#13)"


def by_curve(names: list[str]) -> list[str]:
    curves = [entry for i, at in enumerate(names) for entry in curve(100 + 10 * i, LENGTHS[at], at)]
    inside = ",".join(f"#{100 + 10 * i}" for i in range(len(names)))
    return [*curves, f"#90=GEOMETRIC_CURVE_SET('c',({inside}))", wireframe("#90")]


def by_set(names: list[str]) -> list[str]:
    found = [wireframe(",".join(f"#{90 + i}" for i in range(len(names))))]
    for i, name in enumerate(names):
        found += curve(100 + 10 * i, LENGTHS[name], f"Spline.{9 - i}")
        found.append(f"#{90 + i}=GEOMETRIC_SET('{name}',(#{100 + 10 * i}))")
    return found


def by_layer(names: list[str]) -> list[str]:
    curves = [
        entry for i, at in enumerate(names) for entry in curve(100 + 10 * i, LENGTHS[at], "c")
    ]
    layers = [
        f"#{80 + i}=PRESENTATION_LAYER_ASSIGNMENT('{name}','',(#{100 + 10 * i}))"
        for i, name in enumerate(names)
    ]
    inside = ",".join(f"#{100 + 10 * i}" for i in range(len(names)))
    return [*curves, *layers, f"#90=GEOMETRIC_CURVE_SET('',({inside}))", wireframe("#90")]


def by_group(names: list[str]) -> list[str]:
    groups = [
        entry
        for i, name in enumerate(names)
        for entry in (
            f"#{70 + i}=GROUP('{name}','')",
            f"#{80 + i}=APPLIED_GROUP_ASSIGNMENT(#{70 + i},(#{100 + 10 * i}))",
        )
    ]
    curves = [entry for i, at in enumerate(names) for entry in curve(100 + 10 * i, LENGTHS[at])]
    inside = ",".join(f"#{100 + 10 * i}" for i in range(len(names)))
    return [*curves, *groups, f"#90=GEOMETRIC_CURVE_SET('',({inside}))", wireframe("#90")]


def by_wire_model(names: list[str]) -> list[str]:
    models = ",".join(f"#{90 + i}" for i in range(len(names)))
    found = [wireframe(models, kind="EDGE_BASED_WIREFRAME")]
    for i, name in enumerate(names):
        found += edge(100 + 10 * i, LENGTHS[name])
        found.append(f"#{90 + i}=EDGE_BASED_WIREFRAME_MODEL('{name}',(#{80 + i}))")
        found.append(f"#{80 + i}=CONNECTED_EDGE_SET('',(#{103 + 10 * i}))")
    return found


def by_edge(names: list[str]) -> list[str]:
    models = ",".join(f"#{90 + i}" for i in range(len(names)))
    found = [wireframe(models, kind="EDGE_BASED_WIREFRAME")]
    for i, name in enumerate(names):
        found += edge(100 + 10 * i, LENGTHS[name], name)
        found.append(f"#{90 + i}=EDGE_BASED_WIREFRAME_MODEL('m{i}',(#{80 + i}))")
        found.append(f"#{80 + i}=CONNECTED_EDGE_SET('',(#{103 + 10 * i}))")
    return found


def by_trimmed(names: list[str]) -> list[str]:
    found = []
    for i, name in enumerate(names):
        base = 100 + 10 * i
        found += curve(base, LENGTHS[name], f"base {i}")
        found.append(
            f"#{base + 3}=TRIMMED_CURVE('{name}',#{base},(PARAMETER_VALUE(0.)),"
            "(PARAMETER_VALUE(1.)),.T.,.PARAMETER.)"
        )
    inside = ",".join(f"#{103 + 10 * i}" for i in range(len(names)))
    return [*found, f"#90=GEOMETRIC_CURVE_SET('c',({inside}))", wireframe("#90")]


STRUCTURES = [by_curve, by_set, by_layer, by_group, by_wire_model, by_edge, by_trimmed]
CONTEXT = (
    "#13=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))"
    "REPRESENTATION_CONTEXT('','3D'));\n"
)


def written(path: Path, entities: list[str]) -> Path:
    text = (
        HEAD + PRODUCT + UNITS["mm"] + CONTEXT + "".join(f"{line};\n" for line in entities) + TAIL
    )
    path.write_text(text)
    return path


def roles_of(path: Path) -> list[tuple[float, float]]:
    strips = choose_inputs(read_cad(path)).strips
    return [(round(strip.p.measure, 6), round(strip.q.measure, 6)) for strip in strips]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("names", [["P", "Q"], ["Q", "P"], ["axis", "Q", "P"]])
@pytest.mark.parametrize("structure", STRUCTURES)
def test_roles_go_by_name_whatever_carries_it(tmp_path: Path, structure, names, seed: int) -> None:
    entities = structure(names)
    random.Random(seed).shuffle(entities)
    assert roles_of(written(tmp_path / "shoe.step", entities)) == [(50.0, 60.0)]


@pytest.mark.parametrize("is_q_first", [False, True])
@pytest.mark.parametrize("schema", ["AP203", "AP214IS", "AP242DIS"])
def test_roles_in_files_of_the_kernels_writers(
    tmp_path: Path, schema: str, is_q_first: bool
) -> None:
    silence_kernel()
    document = new_document()
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    rails = [("P", 50.0), ("Q", 60.0), ("upper", 0.0)]
    for name, length in rails[::-1] if is_q_first else rails:
        y = length or 5.0
        shape = line((0, y, 0), (length, y, 0)) if length else faces_of(box())[0]
        set_name(tool.AddShape(shape, False), name)
    writer = STEPCAFControl_Writer()
    writer.SetNameMode(True)
    with kernel_parameters({"write.step.schema": schema}):
        writer.Transfer(document, STEPControl_AsIs)
        writer.Write(str(tmp_path / "shoe.step"))
    assert Interface_Static.CVal_s("write.step.schema") is not None
    chosen = choose_inputs(read_cad(tmp_path / "shoe.step"))
    assert roles_of(tmp_path / "shoe.step") == [(50.0, 60.0)]
    assert chosen.upper is not None
    assert chosen.upper.name == "upper"


def test_the_most_specific_name_counts(tmp_path: Path) -> None:
    entities = [
        *by_curve(["Q", "P"]),
        "#80=PRESENTATION_LAYER_ASSIGNMENT('P','',(#100,#110))",
    ]
    assert roles_of(written(tmp_path / "shoe.step", entities)) == [(50.0, 60.0)]


def test_two_candidates_for_one_role_are_both_listed(tmp_path: Path) -> None:
    entities = [*by_layer(["P", "axis"]), "#85=PRESENTATION_LAYER_ASSIGNMENT('P','',(#110))"]
    with pytest.raises(InputError, match=r"\[1\].*50 mm.*\[2\].*70 mm"):
        roles_of(written(tmp_path / "shoe.step", [*entities, *curve(300, 60.0)]))


def test_what_the_file_hides_is_no_candidate_unless_it_is_named(tmp_path: Path) -> None:
    hidden = ["#60=INVISIBILITY((#61))", "#61=STYLED_ITEM('',(),#120)"]
    entities = by_curve(["Q", "P", "axis"])
    unnamed = [entity.replace("'P'", "''").replace("'Q'", "''") for entity in entities]
    shown = read_cad(written(tmp_path / "shoe.step", [*unnamed, *hidden])).curves()
    assert [round(rail.measure) for rail in shown] == [60, 50]
    named = by_curve(["axis", "Q", "P"])
    assert roles_of(written(tmp_path / "named.step", [*named, *hidden])) == [(50.0, 60.0)]


def test_two_names_without_roles_are_taken_in_their_own_order(tmp_path: Path) -> None:
    for names in (["P", "Q"], ["Q", "P"]):
        entities = [
            entity.replace("'P'", "'Curve 9'").replace("'Q'", "'Curve 10'")
            for entity in by_curve(names)
        ]
        assert roles_of(written(tmp_path / "shoe.step", entities)) == [(50.0, 60.0)]
