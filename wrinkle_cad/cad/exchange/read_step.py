"""STEP -> named shapes, through the kernel's document of names, colors and placements."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Final

from OCP.IFSelect import IFSelect_RetDone
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.exchange.step.links import link_fault
from wrinkle_cad.cad.exchange.step.names import curve_names
from wrinkle_cad.cad.exchange.step.text import check_step, length_units, plain_text, why_no_shape
from wrinkle_cad.cad.kernel.shape_index import ShapeIndex
from wrinkle_cad.cad.kernel.steps import KERNEL_ERRORS
from wrinkle_cad.cad.kernel.topology import as_edge, edges_of, faces_of, kind_name
from wrinkle_cad.files.names import error_words

from .collect import Found, listed, take_apart
from .loose_edges import chain_edges
from .shapes import CURVE_KINDS, CadFile, has_role
from .sniff import STEP, Source
from .units import check_unit, unit_words
from .xde import Leaf, kernel_parameters, leaves_of, new_document, proper_name, silence_kernel

_NAMED_SURFACE: Final = re.compile(
    rb"\b(?:ADVANCED_FACE|FACE_SURFACE|OPEN_SHELL|CLOSED_SHELL)\s*\(\s*'(?!'|NONE'|Unnamed')"
)


def read(source: Source, unit: str | None) -> CadFile:
    """Reads the content of a STEP file.

    Args:
        source: the file.
        unit: the unit of a file that declares none.

    Raises:
        InputError: as for ``read_cad``.
    """
    text = plain_text(source.content)
    check_step(source, text)
    fault = link_fault(text)
    if fault is not None:
        raise source.fail(f"damaged: {fault}. Export it again.")
    declared = length_units(text)
    mm_per_unit = check_unit(source, declared, unit)
    leaves = _leaves(source, text)
    shapes = listed(source, _found(leaves, text), mm_per_unit)
    if not any(shape.measure > 0.0 for shape in shapes):
        raise source.fail(why_no_shape(text))
    words = unit_words(declared, unit)
    return CadFile(source.path, STEP, words, shapes, source.is_compressed)


def _leaves(source: Source, text: bytes) -> list[Leaf]:
    silence_kernel()
    document = new_document()
    try:
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        reader.SetColorMode(True)
        has_names = int(bool(_NAMED_SURFACE.search(text)))
        with kernel_parameters(
            {"xstep.cascade.unit": "MM", "read.stepcaf.subshapes.name": has_names}
        ):
            if reader.ReadStream(source.path.name, io.BytesIO(text)) != IFSelect_RetDone:
                raise source.fail(
                    "damaged: not readable as STEP although its frame is whole. Export it again."
                )
            if reader.NbRootsForTransfer() == 0 or not reader.Transfer(document):
                return []
        return leaves_of(document)
    except KERNEL_ERRORS as error:
        raise source.fail(
            f"damaged: the CAD kernel fails on it ({error_words(error)}). Export it again."
        ) from error


def _found(leaves: list[Leaf], text: bytes) -> list[Found]:
    """Returns what can be chosen: per named occurrence the edges that belong together joined."""
    own_names = curve_names(text) if len(leaves) == 1 else []
    found: list[Found] = []
    for _, group in groupby(leaves, key=lambda leaf: leaf.named_at):
        found += _found_in_group(list(group), own_names)
    curves = [item for item in found if kind_name(item.shape) in CURVE_KINDS]
    return _loosened(found) if len(curves) == 1 else found


def _found_in_group(leaves: list[Leaf], own_names: list[str]) -> list[Found]:
    pieces = [
        item
        for leaf in leaves
        for item in take_apart(leaf.shape, leaf.name, leaf.color, leaf.faces)
    ]
    pieces = _renamed(pieces, own_names)
    is_loose = [kind_name(item.shape) == "edge" for item in pieces]
    loose = [item for item, is_edge in zip(pieces, is_loose, strict=True) if is_edge]
    rest = [item for item, is_edge in zip(pieces, is_loose, strict=True) if not is_edge]
    solids = [item.shape for item in pieces if kind_name(item.shape) == "solid"]
    inner = [item for leaf in leaves for item in _inner(leaf, solids)]
    return [*rest, *_chained(loose), *inner]


def _inner(leaf: Leaf, solids: Sequence[TopoDS_Shape]) -> Iterator[Found]:
    """Yields the named shells and faces of solids; of shells only the faces named for a role.

    A shell is chosen as a whole, and may have hundreds of faces under a few names.
    """
    if not leaf.named_surfaces:
        return
    own = ShapeIndex(face for solid in solids for face in faces_of(solid))
    for name, shape, color in leaf.named_surfaces:
        if kind_name(shape) == "shell" or has_role(name) or own.find(shape) >= 0:
            yield Found(shape, name, color or leaf.color, is_free=False)


def _renamed(pieces: list[Found], own_names: list[str]) -> list[Found]:
    """Gives curves the names that the file has for each, if it has one entry per curve."""
    curves = [i for i, item in enumerate(pieces) if kind_name(item.shape) in CURVE_KINDS]
    if len(curves) != len(own_names):
        return pieces
    named = list(pieces)
    for i, name in zip(curves, own_names, strict=True):
        named[i] = replace(pieces[i], name=proper_name(name) or pieces[i].name)
    return named


def _chained(loose: list[Found]) -> list[Found]:
    by_name: dict[str, list[Found]] = {}
    for item in loose:
        by_name.setdefault(item.name, []).append(item)
    return [
        Found(chain, name, items[0].color)
        for name, items in by_name.items()
        for chain in chain_edges([as_edge(item.shape) for item in items])
    ]


def _loosened(found: list[Found]) -> list[Found]:
    """Takes a wire of two edges, the only curve, apart: they are two rails that meet at an end."""
    apart: list[Found] = []
    for item in found:
        edges = edges_of(item.shape) if kind_name(item.shape) == "wire" else []
        if len(edges) == 2 and not has_role(item.name):
            apart += [replace(item, shape=edge) for edge in edges]
        else:
            apart.append(item)
    return apart
