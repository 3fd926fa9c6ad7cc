"""Shapes and STEP texts that several tests of reading and writing start from."""

from __future__ import annotations

import io
from itertools import pairwise
from pathlib import Path

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.BRepTools import BRepTools
from OCP.gp import gp_Pnt
from OCP.TopoDS import TopoDS_Edge, TopoDS_Shape

from wrinkle_cad.cad.exchange.shapes import Part
from wrinkle_cad.cad.exchange.write import write_step
from wrinkle_cad.cad.kernel.splines import make_curve

Point = tuple[float, float, float]


def arc(y: float, *, height: float = 20.0) -> TopoDS_Edge:
    """A parabola over x from 0 to 100 at the given y."""
    poles = [(0.0, y, 0.0), (50.0, y, height), (100.0, y, 0.0)]
    return BRepBuilderAPI_MakeEdge(make_curve(poles, [0.0, 1.0], [3, 3], 2)).Edge()


def line(start: Point, end: Point) -> TopoDS_Edge:
    return BRepBuilderAPI_MakeEdge(gp_Pnt(*start), gp_Pnt(*end)).Edge()


def polyline(*points: Point) -> TopoDS_Shape:
    """A wire of straight edges."""
    maker = BRepBuilderAPI_MakeWire()
    for start, end in pairwise(points):
        maker.Add(line(start, end))
    return maker.Wire()


def box(size: float = 10.0) -> TopoDS_Shape:
    return BRepPrimAPI_MakeBox(size, size, size).Shape()


def strip_file(path: Path, names: tuple[str, str] = ("P", "Q")) -> Path:
    """Writes two parabolas 30 mm apart."""
    write_step(path, [Part(arc(0.0), names[0]), Part(arc(30.0), names[1])])
    return path


HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"
PRODUCT = """#1=APPLICATION_CONTEXT('mechanical design');
#2=PRODUCT_CONTEXT('',#1,'mechanical');
#3=PRODUCT('part','part','',(#2));
#4=PRODUCT_DEFINITION_FORMATION('','',#3);
#5=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#6=PRODUCT_DEFINITION('','',#4,#5);
#7=PRODUCT_DEFINITION_SHAPE('','',#6);
#11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#12=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#14=SHAPE_DEFINITION_REPRESENTATION(#7,#15);
"""
UNITS = {
    "mm": "#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n",
    "cm": "#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));\n",
    "m": "#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));\n",
    "inch": """#8=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#9=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#8);
#16=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#10=(CONVERSION_BASED_UNIT('INCH',#9)LENGTH_UNIT()NAMED_UNIT(#16));
""",
    "ft": """#8=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));
#9=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.3048),#8);
#16=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#10=(CONVERSION_BASED_UNIT('FOOT',#9)LENGTH_UNIT()NAMED_UNIT(#16));
""",
}


def curves_text(unit: str | None = "mm", *, names: tuple[str, str] = ("", "")) -> str:
    """A hand-written STEP file of two straight curves of lengths 2 and 3 in its unit."""
    units = UNITS[unit] if unit else ""
    assigned = "(#10,#11,#12)" if unit else "(#11,#12)"
    context = (
        f"#13=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT({assigned})"
        "REPRESENTATION_CONTEXT('','3D'));\n"
        "#15=GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION('',(#20,#30),#13);\n"
    )
    curves = "".join(
        f"#{base}=GEOMETRIC_CURVE_SET('',(#{base + 1}));\n"
        f"#{base + 1}=B_SPLINE_CURVE_WITH_KNOTS('{name}',1,(#{base + 2},#{base + 3}),"
        ".UNSPECIFIED.,.F.,.F.,(2,2),(0.,1.),.UNSPECIFIED.);\n"
        f"#{base + 2}=CARTESIAN_POINT('',(0.,{y},0.));\n"
        f"#{base + 3}=CARTESIAN_POINT('',({length},{y},0.));\n"
        for base, name, length, y in ((20, names[0], 2.0, 0.0), (30, names[1], 3.0, 1.0))
    )
    return HEAD + PRODUCT + units + context + curves + TAIL


def brep_bytes(shape: TopoDS_Shape) -> bytes:
    """The content of a BREP file, the kernel's own text format."""
    stream = io.BytesIO()
    BRepTools.Write_s(shape, stream)
    return stream.getvalue()
