"""The one place where OCP 7.9 (build123d 0.12) and OCP 8.0 (build123d 0.13) differ.

Collections stand beside what they collect in 7.9 and all in one module in 8.0; every other module
takes them from here, under names that say what they hold. Casts need nothing here: the calls
``TopoDS.Edge(...)``, ``TopoDS.Face(...)`` that the package uses work in both.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from OCP.TopoDS import TopoDS_Shape

try:  # OCP 7.9
    from OCP.TColgp import TColgp_Array1OfPnt, TColgp_Array1OfPnt2d, TColgp_Array2OfPnt
    from OCP.TColStd import TColStd_Array1OfInteger, TColStd_Array1OfReal, TColStd_Array2OfReal
    from OCP.TDF import TDF_LabelSequence
    from OCP.TopTools import TopTools_IndexedMapOfShape, TopTools_ListOfShape
except ImportError:  # OCP 8.0
    from OCP.collections import Array1_double as TColStd_Array1OfReal
    from OCP.collections import Array1_gp_Pnt as TColgp_Array1OfPnt
    from OCP.collections import Array1_gp_Pnt2d as TColgp_Array1OfPnt2d
    from OCP.collections import Array1_int as TColStd_Array1OfInteger
    from OCP.collections import Array2_double as TColStd_Array2OfReal
    from OCP.collections import Array2_gp_Pnt as TColgp_Array2OfPnt
    from OCP.collections import (
        IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as TopTools_IndexedMapOfShape,
    )
    from OCP.collections import List_TopoDS_Shape as TopTools_ListOfShape
    from OCP.collections import Sequence_TDF_Label as TDF_LabelSequence

IntegerRow: TypeAlias = TColStd_Array1OfInteger
RealRow: TypeAlias = TColStd_Array1OfReal
RealGrid: TypeAlias = TColStd_Array2OfReal
PointRow: TypeAlias = TColgp_Array1OfPnt
PlanePointRow: TypeAlias = TColgp_Array1OfPnt2d
PointGrid: TypeAlias = TColgp_Array2OfPnt
ShapeList: TypeAlias = TopTools_ListOfShape
ShapeMap: TypeAlias = TopTools_IndexedMapOfShape
LabelList: TypeAlias = TDF_LabelSequence


def shape_list(shapes: Iterable[TopoDS_Shape]) -> ShapeList:
    """Returns the shapes as the list that the kernel's algorithms take."""
    listed = ShapeList()
    for shape in shapes:
        listed.Append(shape)
    return listed
