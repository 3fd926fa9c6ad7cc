"""Rails keep the roles of their names in the files that other programs write."""

from __future__ import annotations

import importlib.util
import subprocess
from collections.abc import Sequence
from itertools import product
from pathlib import Path

import build123d as b3d
import pytest
from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Writer
from OCP.STEPControl import STEPControl_AsIs
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Edge
from OCP.XCAFDoc import XCAFDoc_DocumentTool

from tests.cad.makers import box, line
from wrinkle_cad.cad.exchange.choose import Chosen, choose_inputs
from wrinkle_cad.cad.exchange.read import read_cad
from wrinkle_cad.cad.exchange.xde import kernel_parameters, new_document, set_name, silence_kernel
from wrinkle_cad.cad.kernel.topology import faces_of

from .structures import LENGTHS

HAS_CADQUERY = importlib.util.find_spec("cadquery") is not None
needs_cadquery = pytest.mark.skipif(not HAS_CADQUERY, reason="CadQuery does not fit this kernel")
ORDERS = (("P", "Q"), ("Q", "P"), ("axis", "Q", "P"))


def chosen_in(path: Path) -> Chosen:
    return choose_inputs(read_cad(path))


def roles_of(path: Path) -> dict[str, tuple[float, float]]:
    strips = chosen_in(path).strips
    return {at.name: (round(at.p.measure, 6), round(at.q.measure, 6)) for at in strips}


def rail(name: str, z: float = 0.0) -> TopoDS_Edge:
    y = LENGTHS[name]
    return line((0.0, y, z), (y, y, z))


Names = Sequence[str]


class Document:
    """The kernel's document, as its own programs fill it."""

    def __init__(self) -> None:
        silence_kernel()
        self.own: TDocStd_Document = new_document()
        self.shapes = XCAFDoc_DocumentTool.ShapeTool_s(self.own.Main())

    def add(self, shape: object, name: str = "") -> TDF_Label:
        label = self.shapes.AddShape(shape, False)
        set_name(label, name)
        return label

    def assembly(self, name: str, parts: Sequence[TDF_Label], names: Names = ()) -> TDF_Label:
        label = self.shapes.NewShape()
        set_name(label, name)
        for i, part in enumerate(parts):
            placed = self.shapes.AddComponent(label, part, TopLoc_Location())
            set_name(placed, names[i] if names else f"{i}")
        self.shapes.UpdateAssemblies()
        return label

    def put_on_layer(self, label: TDF_Label, name: str) -> None:
        layers = XCAFDoc_DocumentTool.LayerTool_s(self.own.Main())
        layers.SetLayer(label, TCollection_ExtendedString(name, True))

    def hide(self, label: TDF_Label) -> None:
        XCAFDoc_DocumentTool.ColorTool_s(self.own.Main()).SetVisibility(label, False)

    def write(self, path: Path, schema: str) -> None:
        writer = STEPCAFControl_Writer()
        for switch in (writer.SetNameMode, writer.SetLayerMode, writer.SetColorMode):
            switch(True)
        with kernel_parameters({"write.step.schema": schema}):
            writer.Transfer(self.own, STEPControl_AsIs)
            assert writer.Write(str(path)) == IFSelect_RetDone


def parts_with_an_upper(document: Document, names: Names) -> None:
    document.add(faces_of(box())[0], "upper")
    for name in names:
        document.add(rail(name), name)


def layers(document: Document, names: Names) -> None:
    for name in names:
        document.put_on_layer(document.add(rail(name), "curve"), name)


def instances(document: Document, names: Names) -> None:
    document.assembly("shoe", [document.add(rail(name), "curve") for name in names], names)


def hidden_helper(document: Document, names: Names) -> None:
    """The third curve is shown as little as a helper should be, and has the name of a rail."""
    for name in names:
        label = document.add(rail(name), name.replace("axis", "P"))
        if name == "axis":
            document.hide(label)


def assemblies(document: Document, names: Names) -> None:
    for name in names:
        half = LENGTHS[name] / 2
        ends = [(half * i, LENGTHS[name], 0.0) for i in range(3)]
        lines = [document.add(line(ends[i], ends[i + 1]), f"line {i}") for i in range(2)]
        document.assembly(name, lines)


DOCUMENTS = (parts_with_an_upper, layers, instances, hidden_helper, assemblies)


@pytest.mark.parametrize("names", ORDERS)
@pytest.mark.parametrize("fill", DOCUMENTS)
@pytest.mark.parametrize("schema", ["AP203", "AP214IS", "AP242DIS"])
def test_roles_in_files_of_the_kernels_writers(
    tmp_path: Path, schema: str, fill, names: Names
) -> None:
    document = Document()
    fill(document, names)
    document.write(tmp_path / "shoe.step", schema)
    assert list(roles_of(tmp_path / "shoe.step").values()) == [(50.0, 60.0)]
    upper = chosen_in(tmp_path / "shoe.step").upper
    assert (upper is not None) == (fill is parts_with_an_upper)


def test_a_hidden_solid_is_no_upper_beside_a_surface_of_the_same_part(tmp_path: Path) -> None:
    document = Document()
    for name in ("P", "Q"):
        document.add(rail(name), name)
    surface, solid = document.add(faces_of(box())[0], "upper"), document.add(box(), "upper")
    document.hide(solid)
    assert not surface.IsNull()
    document.write(tmp_path / "shoe.step", "AP214IS")
    upper = chosen_in(tmp_path / "shoe.step").upper
    assert upper is not None
    assert (upper.kind, upper.is_hidden) == ("face", False) or upper.kind == "shell"


@pytest.mark.parametrize("names", ORDERS)
def test_roles_in_assemblies_of_build123d(tmp_path: Path, names: Names) -> None:
    strips = []
    for z, strip in ((0.0, "toe"), (30.0, "heel")):
        edges = [b3d.Edge(rail(name, z)) for name in names]
        for edge, name in zip(edges, names, strict=True):
            edge.label = name
        strips.append(b3d.Compound(label=strip, children=edges))
    sides = [b3d.Face.make_rect(9, 9), b3d.Pos(9, 0, 0) * b3d.Face.make_rect(9, 9)]
    for side, name in zip(sides, ("left", "right"), strict=True):
        side.label = name
    strips.append(b3d.Compound(label="upper", children=sides))
    b3d.export_step(b3d.Compound(label="shoe", children=strips), tmp_path / "shoe.step")
    assert roles_of(tmp_path / "shoe.step") == {"toe": (50.0, 60.0), "heel": (50.0, 60.0)}
    upper = chosen_in(tmp_path / "shoe.step").upper
    assert upper is not None
    assert upper.measure == pytest.approx(162.0)


@needs_cadquery
@pytest.mark.parametrize("names", ORDERS)
def test_roles_in_assemblies_of_cadquery(tmp_path: Path, names: Names) -> None:
    import cadquery as cq

    shoe = cq.Assembly(name="shoe")
    for name in names:
        y = LENGTHS[name]
        shoe.add(cq.Workplane().moveTo(0, y).lineTo(y / 2, y).lineTo(y, y).wire(), name=name)
    shoe.export(str(tmp_path / "shoe.step"))
    assert roles_of(tmp_path / "shoe.step") == {"strip": (50.0, 60.0)}


FREECAD = """
import FreeCAD, Import, Part, Sketcher
from FreeCAD import Placement, Rotation, Vector

LENGTHS, ORDERS, FOLDER = {lengths!r}, {orders!r}, {folder!r}

def line(name, start, end, z=0.0):
    y = LENGTHS[name]
    return Part.makeLine(Vector(start, y, z), Vector(end, y, z))

def edge(document, name, label="", z=0.0):
    made = document.addObject("Part::Feature", "f")
    made.Shape, made.Label = line(name, 0, LENGTHS[name], z), label or name
    return made

def features(document, names):
    return [edge(document, name) for name in names]

def wires(document, names):
    made = features(document, names)
    for one, name in zip(made, names):
        half = LENGTHS[name] / 2
        one.Shape = Part.Wire([line(name, 0, half), line(name, half, 2 * half)])
    return made

def sketches(document, names):
    made = []
    for name in names:
        sketch = document.addObject("Sketcher::SketchObject", "Sketch")
        y, half = LENGTHS[name], LENGTHS[name] / 2
        for i in range(2):
            ends = Vector(i * half, y, 0), Vector((i + 1) * half, y, 0)
            sketch.addGeometry(Part.LineSegment(*ends))
        sketch.Label = name
        made.append(sketch)
    return made

def grouped(document, names):
    group = document.addObject("App::DocumentObjectGroup", "Group")
    for one in features(document, names):
        group.addObject(one)
    return [group]

def part(document, names):
    made = document.addObject("App::Part", "Part")
    for one in features(document, names):
        made.addObject(one)
    return [made]

def part_per_rail(document, names):
    made = []
    for i, name in enumerate(names):
        holder = document.addObject("App::Part", "Part")
        holder.Label = name
        holder.addObject(edge(document, name, f"Line {{i}}"))
        made.append(holder)
    return made

def links(document, names):
    made = []
    for name in names:
        link = document.addObject("App::Link", "Link")
        link.LinkedObject, link.Label = edge(document, name, "base of " + name), name
        made.append(link)
    return made

def two_parts(document, names):
    made = []
    for z, strip in ((0, "toe"), (30, "heel")):
        holder = document.addObject("App::Part", "Part")
        holder.Label = strip
        for name in names:
            holder.addObject(edge(document, name, z=z))
        made.append(holder)
    return made

for make in (features, wires, sketches, grouped, part, part_per_rail, links, two_parts):
    for i, names in enumerate(ORDERS):
        document = FreeCAD.newDocument(f"{{make.__name__}}{{i}}")
        made = make(document, names)
        document.recompute()
        Import.export(made, f"{{FOLDER}}/{{make.__name__}} {{i}}.step")
"""
OF_FREECAD = ("features", "wires", "sketches", "grouped", "part", "part_per_rail", "links")


@pytest.fixture(scope="module")
def of_freecad(freecadcmd: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of all files that FreeCAD wrote."""
    folder = tmp_path_factory.mktemp("freecad")
    script = folder / "write.py"
    script.write_text(FREECAD.format(lengths=LENGTHS, orders=ORDERS, folder=str(folder)))
    subprocess.run([freecadcmd, str(script)], capture_output=True, timeout=120, check=True)
    return folder


@pytest.mark.freecad
@pytest.mark.parametrize(("kind", "order"), list(product(OF_FREECAD, range(3))))
def test_roles_in_files_of_freecad(of_freecad: Path, kind: str, order: int) -> None:
    assert roles_of(of_freecad / f"{kind} {order}.step") == {"strip": (50.0, 60.0)}


@pytest.mark.freecad
@pytest.mark.parametrize("order", range(3))
def test_two_parts_of_freecad_are_two_strips(of_freecad: Path, order: int) -> None:
    """FreeCAD calls the rails of the second one P001 and Q001."""
    found = roles_of(of_freecad / f"two_parts {order}.step")
    assert found == {"toe": (50.0, 60.0), "heel": (50.0, 60.0)}
