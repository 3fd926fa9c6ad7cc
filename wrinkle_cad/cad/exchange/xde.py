"""The kernel's document of named, colored, placed shapes (XDE): read into plain records.

Labels hold names and colors; an assembly's components hold placements and instance names. A leaf
is a product that is no assembly, at one place. Names come from the product unless its instance says
more; a leaf without a name takes that of its nearest named ancestor.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.Quantity import Quantity_Color, Quantity_TOC_sRGB
from OCP.TCollection import TCollection_AsciiString, TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label, TDF_Tool
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape
from OCP.XCAFDoc import (
    XCAFDoc_ColorCurv,
    XCAFDoc_ColorGen,
    XCAFDoc_ColorSurf,
    XCAFDoc_ColorTool,
    XCAFDoc_DocumentTool,
    XCAFDoc_ShapeTool,
)

from wrinkle_cad.cad.exchange.step.names import unmarked
from wrinkle_cad.cad.kernel.topology import as_face, faces_of
from wrinkle_cad.cad.kernel.versions import LabelList
from wrinkle_cad.files.names import one_line

from .shapes import FaceStyle, Holder, has_role

Color = tuple[float, float, float]

# Names that programs give by themselves: the kernel, build123d, SolidWorks.
_AUTOMATIC: Final = re.compile(
    r"Open CASCADE STEP translator.*|Open CASCADE Shape Model|=>\[[\d:]+\]|NONE|Unnamed"
    r"|COMPOUND|COMPSOLID|SOLID|SHELL|FACE|WIRE|EDGE|VERTEX|SHAPE|ASSEMBLY"
)

# What stands for the name of an instance without one: its number.
_NUMBER: Final = re.compile(r"(?:NAUO)?\d+")


@dataclass(frozen=True, slots=True)
class _Way:
    """From the root of the document down to a label."""

    place: TopLoc_Location
    path: str
    color: Color | None = None
    holders: tuple[Holder, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Leaf:
    """One product at one place."""

    shape: TopoDS_Shape
    """World coordinates."""
    name: str
    """Its own name or that of the nearest named ancestor; empty if none has one."""
    named_at: str
    """Identifies the occurrence that carries the name; the leaf itself if there is no name."""
    holders: tuple[Holder, ...]
    """Everything that has a name and holds it, the nearest first, itself included."""
    color: Color | None
    """Its own color, or that of its instance."""
    named_surfaces: tuple[tuple[str, TopoDS_Shape, Color | None], ...]
    """Faces and shells inside it that have names of their own, and their own colors."""
    faces: tuple[FaceStyle, ...]
    """Faces inside it that have names or colors of their own."""


def silence_kernel() -> None:
    """Keeps the kernel's statistics and warnings off the process's output, for good."""
    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)


def set_parameter(name: str, value: str | int) -> None:
    """Sets one of the kernel's process-wide exchange parameters.

    Raises:
        ValueError: the kernel knows no such parameter or value (a mistake in this program).
    """
    is_set = (
        Interface_Static.SetIVal_s(name, value)
        if isinstance(value, int)
        else Interface_Static.SetCVal_s(name, value)
    )
    if not is_set:
        raise ValueError(f"the kernel refuses {name} = {value}")


@contextmanager
def kernel_parameters(wanted: Mapping[str, str | int]) -> Iterator[None]:
    """Sets process-wide exchange parameters of the kernel for a while; see ``set_parameter``.

    Other libraries in the process rely on them, as this one does.
    """
    before = {
        name: Interface_Static.IVal_s(name)
        if isinstance(value, int)
        else Interface_Static.CVal_s(name)
        for name, value in wanted.items()
    }
    try:
        for name, value in wanted.items():
            set_parameter(name, value)
        yield
    finally:
        for name, value in before.items():
            set_parameter(name, value)


def new_document() -> TDocStd_Document:
    """Returns an empty document that belongs to no application, so it goes when it is dropped."""
    return TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))


def set_name(label: TDF_Label, name: str) -> None:
    """Names a label."""
    TDataStd_Name.Set_s(label, TCollection_ExtendedString(name, True))


def leaves_of(document: TDocStd_Document) -> list[Leaf]:
    """Returns every leaf of a document, in the file's order."""
    tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    roots = LabelList()
    tool.GetFreeShapes(roots)
    labels = [roots.Value(i) for i in range(1, roots.Length() + 1)]
    uses = Counter(_references(labels))
    way = _Way(TopLoc_Location(), "")
    return [leaf for label in labels for leaf in _walk(label, way, uses)]


def _references(labels: list[TDF_Label]) -> Iterator[str]:
    """Yields the entry of each product as often as it is used below the labels."""
    for label in labels:
        product = _product(label)
        yield _entry(product)
        yield from _references(_components(product))


def _walk(label: TDF_Label, above: _Way, uses: Counter[str]) -> Iterator[Leaf]:
    product = _product(label)
    path = f"{above.path}/{_entry(label)}"
    place, color = above.place, _product_color(product) or above.color
    if XCAFDoc_ShapeTool.IsReference_s(label):
        place = place * XCAFDoc_ShapeTool.GetLocation_s(label)
        color = _color(label) or color
    own = _own_names(label, product, is_repeated=uses[_entry(product)] > 1)
    holders = (*(Holder(name, "product", path) for name in own), *above.holders)
    way = _Way(place, path, color, holders)
    components = _components(product)
    for component in components:
        yield from _walk(component, way, uses)
    if not components:
        shape = XCAFDoc_ShapeTool.GetShape_s(product)
        if not shape.IsNull():
            yield _leaf(product, shape.Moved(place), way)


def _leaf(product: TDF_Label, shape: TopoDS_Shape, way: _Way) -> Leaf:
    """Returns a product at its place; a name that says what it is for counts first."""
    named = next((holder for holder in way.holders if has_role(holder.name)), None)
    named = named or next(iter(way.holders), None)
    return Leaf(
        shape,
        named.name if named else "",
        named.at if named else way.path,
        way.holders,
        way.color,
        tuple(_named_surfaces(product, way.place)),
        tuple(_face_styles(product, way.place)),
    )


def _product(label: TDF_Label) -> TDF_Label:
    if not XCAFDoc_ShapeTool.IsReference_s(label):
        return label
    product = TDF_Label()
    XCAFDoc_ShapeTool.GetReferredShape_s(label, product)
    return product


def _components(product: TDF_Label) -> list[TDF_Label]:
    if not XCAFDoc_ShapeTool.IsAssembly_s(product):
        return []
    found = LabelList()
    XCAFDoc_ShapeTool.GetComponents_s(product, found, False)
    return [found.Value(i) for i in range(1, found.Length() + 1)]


def _own_names(label: TDF_Label, product: TDF_Label, *, is_repeated: bool) -> list[str]:
    """Returns the names of an instance and of its product, the one that tells more first."""
    instance, name = _name(label), _name(product)
    if _NUMBER.fullmatch(instance):
        instance = ""
    is_told = bool(instance) and (is_repeated or not name or has_role(instance))
    both = (instance, name) if is_told else (name, instance)
    return [name for name in dict.fromkeys(both) if name]


def _name(label: TDF_Label) -> str:
    # FindAttribute ends the process where the attribute is missing.
    if not label.IsAttribute(TDataStd_Name.GetID_s()):
        return ""
    attribute = TDataStd_Name()
    label.FindAttribute(TDataStd_Name.GetID_s(), attribute)
    return proper_name(attribute.Get().ToExtString())


def proper_name(raw: str) -> str:
    """Returns a name as a person gave it: empty if a program did, repaired, without line ends."""
    name = one_line(unmarked(_decoded_twice(raw))).strip()
    return "" if _AUTOMATIC.fullmatch(name) else name


def _decoded_twice(name: str) -> str:
    """Repairs a name whose UTF-8 was taken for Latin-1 and encoded again, as build123d writes."""
    try:
        return name.encode("latin-1").decode("utf-8")
    except (UnicodeEncodeError, UnicodeDecodeError):
        return name


def _entry(label: TDF_Label) -> str:
    entry = TCollection_AsciiString()
    TDF_Tool.Entry_s(label, entry)
    return str(entry.ToCString())


def _color(label: TDF_Label) -> Color | None:
    color = Quantity_Color()
    for kind in (XCAFDoc_ColorSurf, XCAFDoc_ColorCurv, XCAFDoc_ColorGen):
        if XCAFDoc_ColorTool.GetColor_s(label, kind, color):
            red, green, blue = color.Values(Quantity_TOC_sRGB)
            # The kernel keeps single precision in linear light.
            return (round(red, 6), round(green, 6), round(blue, 6))
    return None


def _product_color(product: TDF_Label) -> Color | None:
    """Returns a product's color, or the one that its pieces share.

    Colored faces count where nothing larger has a color, and then all faces must have it.
    """
    own = _color(product)
    if own is not None:
        return own
    pieces = [(shape, color) for label, shape in _pieces(product) if (color := _color(label))]
    colors = {color for shape, color in pieces if shape.ShapeType() != TopAbs_FACE}
    faces = [color for shape, color in pieces if shape.ShapeType() == TopAbs_FACE]
    if not colors and faces and len(faces) == len(faces_of(XCAFDoc_ShapeTool.GetShape_s(product))):
        colors = set(faces)
    return colors.pop() if len(colors) == 1 else None


def _pieces(product: TDF_Label) -> Iterator[tuple[TDF_Label, TopoDS_Shape]]:
    """Yields the pieces of a product that have names or colors."""
    found = LabelList()
    XCAFDoc_ShapeTool.GetSubShapes_s(product, found)
    for i in range(1, found.Length() + 1):
        label = found.Value(i)
        yield label, XCAFDoc_ShapeTool.GetShape_s(label)


def _named_surfaces(
    product: TDF_Label, place: TopLoc_Location
) -> Iterator[tuple[str, TopoDS_Shape, Color | None]]:
    for label, shape in _pieces(product):
        name = _name(label)
        if name and shape.ShapeType() in (TopAbs_FACE, TopAbs_SHELL):
            yield name, shape.Moved(place), _color(label)


def _face_styles(product: TDF_Label, place: TopLoc_Location) -> Iterator[FaceStyle]:
    for label, shape in _pieces(product):
        if shape.ShapeType() == TopAbs_FACE:
            name, color = _name(label), _color(label)
            if name or color is not None:
                yield FaceStyle(as_face(shape.Moved(place)), name, color)
