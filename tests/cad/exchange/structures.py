"""STEP texts in the structures that programs write: what carries the names of the rails.

Each function takes the rails' names in the order in which the file is to have them, and returns
the entities. All rails are straight and as long as ``LENGTHS`` says, those of a second strip by 100
longer.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

from tests.cad.makers import HEAD, PRODUCT, TAIL, UNITS

LENGTHS: Final = {"P": 50.0, "Q": 60.0, "axis": 70.0}
CONTEXT: Final = (
    "#13=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))"
    "REPRESENTATION_CONTEXT('','3D'));\n"
)
ROOT: Final = [
    "#15=SHAPE_REPRESENTATION('',(#9904),#13)",
    "#9901=CARTESIAN_POINT('',(0.,0.,0.))",
    "#9902=DIRECTION('',(0.,0.,1.))",
    "#9903=DIRECTION('',(1.,0.,0.))",
    "#9904=AXIS2_PLACEMENT_3D('',#9901,#9902,#9903)",
]
"""The part itself, without geometry of its own."""

Names = Sequence[str]


def step_text(entities: Sequence[str]) -> str:
    """A whole file of these entities beside a product and its units."""
    return HEAD + PRODUCT + UNITS["mm"] + CONTEXT + "".join(f"{at};\n" for at in entities) + TAIL


def written(path: Path, entities: Sequence[str]) -> Path:
    path.write_text(step_text(entities))
    return path


def curve(base: int, length: float, name: str = "", start: float = 0.0) -> list[str]:
    return [
        f"#{base}=B_SPLINE_CURVE_WITH_KNOTS('{name}',1,(#{base + 1},#{base + 2}),"
        ".UNSPECIFIED.,.F.,.F.,(2,2),(0.,1.),.UNSPECIFIED.)",
        f"#{base + 1}=CARTESIAN_POINT('',({start},{base}.,0.))",
        f"#{base + 2}=CARTESIAN_POINT('',({start + length},{base}.,0.))",
    ]


def edge(base: int, length: float, name: str = "") -> list[str]:
    return [
        f"#{base + 3}=EDGE_CURVE('{name}',#{base + 4},#{base + 5},#{base},.T.)",
        f"#{base + 4}=VERTEX_POINT('',#{base + 1})",
        f"#{base + 5}=VERTEX_POINT('',#{base + 2})",
        *curve(base, length),
    ]


def wireframe(
    items: str,
    *,
    kind: str = "GEOMETRICALLY_BOUNDED_WIREFRAME",
    number: int = 15,
    name: str = "",
) -> str:
    return f"#{number}={kind}_SHAPE_REPRESENTATION('{name}',({items}),#13)"


def product(base: int, name: str, representation: int, key: str = "") -> list[str]:
    return [
        f"#{base}=PRODUCT('{key or name}','{name}','',(#2))",
        f"#{base + 1}=PRODUCT_DEFINITION_FORMATION('','',#{base})",
        f"#{base + 2}=PRODUCT_DEFINITION('','',#{base + 1},#5)",
        f"#{base + 3}=PRODUCT_DEFINITION_SHAPE('','',#{base + 2})",
        f"#{base + 4}=SHAPE_DEFINITION_REPRESENTATION(#{base + 3},#{representation})",
    ]


def placed(
    base: int, name: str, *, child: tuple[int, int], parent: tuple[int, int] = (6, 15)
) -> list[str]:
    """An instance of a child in a parent, each by its product definition and representation."""
    return [
        f"#{base}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('{base}','{name}','',#{parent[0]},#{child[0]},$)",
        f"#{base + 1}=PRODUCT_DEFINITION_SHAPE('Placement','',#{base})",
        f"#{base + 2}=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{base + 3},#{base + 1})",
        f"#{base + 3}=(REPRESENTATION_RELATIONSHIP('','',#{child[1]},#{parent[1]})"
        f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{base + 4})"
        "SHAPE_REPRESENTATION_RELATIONSHIP())",
        f"#{base + 4}=ITEM_DEFINED_TRANSFORMATION('','',#9904,#9904)",
    ]


def listed(numbers: Sequence[int]) -> str:
    return ",".join(f"#{number}" for number in numbers)


def by_curve(names: Names) -> list[str]:
    curves = [entry for i, at in enumerate(names) for entry in curve(100 + 10 * i, LENGTHS[at], at)]
    inside = listed([100 + 10 * i for i in range(len(names))])
    return [*curves, f"#90=GEOMETRIC_CURVE_SET('c',({inside}))", wireframe("#90")]


def by_set(names: Names) -> list[str]:
    found = [wireframe(listed([90 + i for i in range(len(names))]))]
    for i, name in enumerate(names):
        found += curve(100 + 10 * i, LENGTHS[name], f"Spline.{9 - i}")
        found.append(f"#{90 + i}=GEOMETRIC_SET('{name}',(#{100 + 10 * i}))")
    return found


def by_layer(names: Names) -> list[str]:
    curves = [
        entry for i, at in enumerate(names) for entry in curve(100 + 10 * i, LENGTHS[at], "c")
    ]
    layers = [
        f"#{80 + i}=PRESENTATION_LAYER_ASSIGNMENT('{name}','',(#{100 + 10 * i}))"
        for i, name in enumerate(names)
    ]
    inside = listed([100 + 10 * i for i in range(len(names))])
    return [*curves, *layers, f"#90=GEOMETRIC_CURVE_SET('',({inside}))", wireframe("#90")]


def by_layer_of_sets(names: Names) -> list[str]:
    found = [wireframe(listed([90 + i for i in range(len(names))]))]
    for i, name in enumerate(names):
        found += curve(100 + 10 * i, LENGTHS[name])
        found.append(f"#{90 + i}=GEOMETRIC_CURVE_SET('',(#{100 + 10 * i}))")
        found.append(f"#{80 + i}=PRESENTATION_LAYER_ASSIGNMENT('{name}','',(#{90 + i}))")
    return found


def by_layer_of_styles(names: Names) -> list[str]:
    found = [wireframe(listed([90 + i for i in range(len(names))]))]
    for i, name in enumerate(names):
        found += curve(100 + 10 * i, LENGTHS[name])
        found.append(f"#{90 + i}=GEOMETRIC_CURVE_SET('',(#{100 + 10 * i}))")
        found.append(f"#{70 + i}=STYLED_ITEM('',(),#{100 + 10 * i})")
        found.append(f"#{80 + i}=PRESENTATION_LAYER_ASSIGNMENT('{name}','',(#{70 + i}))")
    return found


def by_group(names: Names) -> list[str]:
    groups = [
        entry
        for i, name in enumerate(names)
        for entry in (
            f"#{70 + i}=GROUP('{name}','')",
            f"#{80 + i}=APPLIED_GROUP_ASSIGNMENT(#{70 + i},(#{100 + 10 * i}))",
        )
    ]
    curves = [entry for i, at in enumerate(names) for entry in curve(100 + 10 * i, LENGTHS[at])]
    inside = listed([100 + 10 * i for i in range(len(names))])
    return [*curves, *groups, f"#90=GEOMETRIC_CURVE_SET('',({inside}))", wireframe("#90")]


def by_wire_model(names: Names) -> list[str]:
    found = [wireframe(listed([90 + i for i in range(len(names))]), kind="EDGE_BASED_WIREFRAME")]
    for i, name in enumerate(names):
        found += edge(100 + 10 * i, LENGTHS[name])
        found.append(f"#{90 + i}=EDGE_BASED_WIREFRAME_MODEL('{name}',(#{80 + i}))")
        found.append(f"#{80 + i}=CONNECTED_EDGE_SET('',(#{103 + 10 * i}))")
    return found


def by_shells_of_wires(names: Names) -> list[str]:
    found = [wireframe(listed([90 + i for i in range(len(names))]), kind="SHELL_BASED_WIREFRAME")]
    for i, name in enumerate(names):
        at = 100 + 10 * i
        found += edge(at, LENGTHS[name])
        found.append(f"#{at + 6}=ORIENTED_EDGE('',*,*,#{at + 3},.T.)")
        found.append(f"#{at + 7}=EDGE_LOOP('',(#{at + 6}))")
        found.append(f"#{at + 8}=WIRE_SHELL('',(#{at + 7}))")
        found.append(f"#{90 + i}=SHELL_BASED_WIREFRAME_MODEL('{name}',(#{at + 8}))")
    return found


def by_edge(names: Names) -> list[str]:
    found = [wireframe(listed([90 + i for i in range(len(names))]), kind="EDGE_BASED_WIREFRAME")]
    for i, name in enumerate(names):
        found += edge(100 + 10 * i, LENGTHS[name], name)
        found.append(f"#{90 + i}=EDGE_BASED_WIREFRAME_MODEL('m{i}',(#{80 + i}))")
        found.append(f"#{80 + i}=CONNECTED_EDGE_SET('',(#{103 + 10 * i}))")
    return found


def by_trimmed(names: Names) -> list[str]:
    found = []
    for i, name in enumerate(names):
        base = 100 + 10 * i
        found += curve(base, LENGTHS[name], f"base {i}")
        found.append(
            f"#{base + 3}=TRIMMED_CURVE('{name}',#{base},(PARAMETER_VALUE(0.)),"
            "(PARAMETER_VALUE(1.)),.T.,.PARAMETER.)"
        )
    inside = listed([103 + 10 * i for i in range(len(names))])
    return [*found, f"#90=GEOMETRIC_CURVE_SET('c',({inside}))", wireframe("#90")]


def by_curve_on_surface(names: Names) -> list[str]:
    found = [*ROOT[1:], "#9905=PLANE('',#9904)"]
    for i, name in enumerate(names):
        base = 100 + 10 * i
        found += curve(base, LENGTHS[name])
        found.append(f"#{base + 3}=SURFACE_CURVE('{name}',#{base},(#9905),.CURVE_3D.)")
    inside = listed([103 + 10 * i for i in range(len(names))])
    return [*found, f"#90=GEOMETRIC_CURVE_SET('',({inside}))", wireframe("#90")]


def by_polyline(names: Names) -> list[str]:
    found = []
    for i, name in enumerate(names):
        base = 100 + 10 * i
        found.append(f"#{base}=POLYLINE('{name}',(#{base + 1},#{base + 2},#{base + 3}))")
        found += [
            f"#{base + 1 + k}=CARTESIAN_POINT('',({k * LENGTHS[name] / 2},{base}.,0.))"
            for k in range(3)
        ]
    inside = listed([100 + 10 * i for i in range(len(names))])
    return [*found, f"#90=GEOMETRIC_CURVE_SET('',({inside}))", wireframe("#90")]


def by_composite(names: Names) -> list[str]:
    found = []
    for i, name in enumerate(names):
        base, half = 1000 * (i + 1), LENGTHS[name] / 2
        for k, at in enumerate((base + 100, base + 200)):
            found += curve(at, half, f"segment {k}", start=k * half)
            found[-2:] = [line.replace(f"{at}.,0.", f"{base}.,0.") for line in found[-2:]]
            found.append(f"#{at + 3}=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#{at})")
        found.append(f"#{base}=COMPOSITE_CURVE('{name}',(#{base + 103},#{base + 203}),.F.)")
    inside = listed([1000 * (i + 1) for i in range(len(names))])
    return [*found, f"#90=GEOMETRIC_CURVE_SET('',({inside}))", wireframe("#90")]


def by_supplement(names: Names) -> list[str]:
    inside = listed([100 + 10 * i for i in range(len(names))])
    return [
        *ROOT,
        *(entry for i, at in enumerate(names) for entry in curve(100 + 10 * i, LENGTHS[at], at)),
        f"#90=GEOMETRIC_CURVE_SET('',({inside}))",
        "#70=CONSTRUCTIVE_GEOMETRY_REPRESENTATION('supplemental geometry',(#90),#13)",
        "#71=CONSTRUCTIVE_GEOMETRY_REPRESENTATION_RELATIONSHIP('','',#15,#70)",
    ]


def _own_representations(names: Names, *, name_it: bool) -> list[str]:
    """Each rail at 1000, 2000, ... in a representation of its own, 20 further."""
    found = []
    for i, name in enumerate(names):
        base = 1000 * (i + 1)
        found += curve(base, LENGTHS[name])
        found.append(f"#{base + 10}=GEOMETRIC_CURVE_SET('',(#{base}))")
        found.append(
            wireframe(f"#{base + 10},#9904", number=base + 20, name=name if name_it else "")
        )
    return found


def by_representation(names: Names) -> list[str]:
    relations = [
        f"#{base + 21}=SHAPE_REPRESENTATION_RELATIONSHIP('','',#15,#{base + 20})"
        for base in range(1000, 1000 * len(names) + 1, 1000)
    ]
    return [*ROOT, *_own_representations(names, name_it=True), *relations]


def by_mapped_item(names: Names) -> list[str]:
    found = [*ROOT[1:], *_own_representations(names, name_it=False)]
    for i, name in enumerate(names):
        base = 1000 * (i + 1)
        found.append(f"#{base + 21}=REPRESENTATION_MAP(#9904,#{base + 20})")
        found.append(f"#{base + 22}=MAPPED_ITEM('{name}',#{base + 21},#9904)")
    items = listed([1000 * (i + 1) + 22 for i in range(len(names))])
    return [*found, f"#15=SHAPE_REPRESENTATION('',({items}),#13)"]


def by_product(names: Names) -> list[str]:
    found = [*ROOT, *_own_representations(names, name_it=False)]
    for i, name in enumerate(names):
        found += product(1000 * (i + 1) + 30, name, 1000 * (i + 1) + 20)
    return found


def by_key_of_product(names: Names) -> list[str]:
    found = [*ROOT, *_own_representations(names, name_it=False)]
    for i, name in enumerate(names):
        found += product(1000 * (i + 1) + 30, "", 1000 * (i + 1) + 20, key=name)
    return found


def by_instance(names: Names) -> list[str]:
    found = [*ROOT, *_own_representations(names, name_it=False)]
    for i, name in enumerate(names):
        base = 1000 * (i + 1)
        found += product(base + 30, "curve", base + 20)
        found += placed(base + 40, name, child=(base + 32, base + 20))
    return found


def by_assembly(names: Names) -> list[str]:
    """Each rail is an assembly of two lines, which have names of their own."""
    found = [*ROOT]
    for i, name in enumerate(names):
        base, half = 1000 * (i + 1), LENGTHS[name] / 2
        found.append(f"#{base + 20}=SHAPE_REPRESENTATION('',(#9904),#13)")
        found += product(base + 30, name, base + 20)
        found += placed(base + 40, f"{name}.1", child=(base + 32, base + 20))
        for k, at in enumerate((base + 100, base + 200)):
            found += [
                line.replace(f"{at}.,0.", f"{base}.,0.") for line in curve(at, half, start=k * half)
            ]
            found.append(f"#{at + 10}=GEOMETRIC_CURVE_SET('',(#{at}))")
            found.append(wireframe(f"#{at + 10},#9904", number=at + 20))
            found += product(at + 30, f"Line.{k}", at + 20)
            found += placed(at + 40, "", child=(at + 32, at + 20), parent=(base + 32, base + 20))
    return found


def curve_and_layer(names: Names) -> list[str]:
    """The first rail by the name of its curve, the others by that of their layer."""
    found = by_layer(names)
    found[0] = found[0].replace("'c'", f"'{names[0]}'")
    return [entry for entry in found if not entry.startswith("#80=")]


def product_and_set(names: Names) -> list[str]:
    """The first rail in a product of its own, the others by the names of their sets."""
    mine = _own_representations(names[:1], name_it=False)
    return [*ROOT[1:], *mine, *product(1030, names[0], 1020), *by_set(names[1:])]


def representation_and_group(names: Names) -> list[str]:
    mine = [*_own_representations(names[:1], name_it=True)]
    relation = "#1021=SHAPE_REPRESENTATION_RELATIONSHIP('','',#15,#1020)"
    return [*ROOT[1:], *mine, relation, *by_group(names[1:])]


ONE_STRIP: Final = (
    by_curve, by_set, by_layer, by_layer_of_sets, by_layer_of_styles, by_group, by_wire_model,
    by_shells_of_wires, by_edge, by_trimmed, by_curve_on_surface, by_polyline, by_composite,
    by_supplement, by_representation, by_mapped_item, by_product, by_key_of_product, by_instance,
    by_assembly, curve_and_layer, product_and_set, representation_and_group,
)  # fmt: skip


def _two(names: Names) -> list[tuple[str, int, list[int], list[str]]]:
    """Name, base, curves and entities of two strips whose rails have the same names."""
    found = []
    for strip, base, more in (("toe", 10_000, 0.0), ("heel", 20_000, 100.0)):
        at = [base + 1000 * (i + 1) for i in range(len(names))]
        entities = [
            entry
            for number, name in zip(at, names, strict=True)
            for entry in curve(number, LENGTHS[name] + more, name)
        ]
        found.append((strip, base, at, entities))
    return found


def two_by_set(names: Names) -> list[str]:
    found = [wireframe("#10000,#20000")]
    for strip, base, at, entities in _two(names):
        found += [*entities, f"#{base}=GEOMETRIC_CURVE_SET('{strip}',({listed(at)}))"]
    return found


def two_by_layer(names: Names) -> list[str]:
    found, every = [wireframe("#90")], list[int]()
    for strip, base, at, entities in _two(names):
        every += at
        found += [*entities, f"#{base}=PRESENTATION_LAYER_ASSIGNMENT('{strip}','',({listed(at)}))"]
    return [*found, f"#90=GEOMETRIC_CURVE_SET('',({listed(every)}))"]


def two_by_whole_names(names: Names) -> list[str]:
    found, every = [wireframe("#90")], list[int]()
    for strip, _, at, entities in _two(names):
        every += at
        whole = [entry.replace(f"('{name}'", f"('{strip}:{name}'") for entry in entities
                 for name in names if f"('{name}'" in entry]  # fmt: skip
        found += [*whole, *(entry for entry in entities if "CARTESIAN" in entry)]
    return [*found, f"#90=GEOMETRIC_CURVE_SET('',({listed(every)}))"]


def two_by_representation(names: Names) -> list[str]:
    found = [*ROOT]
    for strip, base, at, entities in _two(names):
        found += [*entities, f"#{base}=GEOMETRIC_CURVE_SET('',({listed(at)}))"]
        found.append(wireframe(f"#{base}", number=base + 1, name=strip))
        found.append(f"#{base + 2}=SHAPE_REPRESENTATION_RELATIONSHIP('','',#15,#{base + 1})")
    return found


def two_by_product(names: Names) -> list[str]:
    found = [*ROOT]
    for strip, base, at, entities in _two(names):
        found += [*entities, f"#{base}=GEOMETRIC_CURVE_SET('',({listed(at)}))"]
        found += [wireframe(f"#{base}", number=base + 1), *product(base + 10, strip, base + 1)]
    return found


def two_by_assembly(names: Names) -> list[str]:
    """Each strip is an assembly, and each of its rails a product."""
    found = [*ROOT]
    for strip, base, at, entities in _two(names):
        found += [*entities, f"#{base + 20}=SHAPE_REPRESENTATION('',(#9904),#13)"]
        found += product(base + 30, strip, base + 20)
        found += placed(base + 40, "", child=(base + 32, base + 20))
        for number, name in zip(at, names, strict=True):
            found.append(f"#{number + 10}=GEOMETRIC_CURVE_SET('',(#{number}))")
            found.append(wireframe(f"#{number + 10},#9904", number=number + 20))
            found += product(number + 30, name, number + 20)
            parent = (base + 32, base + 20)
            found += placed(number + 40, "", child=(number + 32, number + 20), parent=parent)
    return found


TWO_STRIPS: Final = (
    two_by_set, two_by_layer, two_by_whole_names, two_by_representation, two_by_product,
    two_by_assembly,
)  # fmt: skip
