"""IGES -> named shapes. Its 80-column records are counted first: the kernel does not miss any."""

from __future__ import annotations

import re
import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Final

from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESCAFControl import IGESCAFControl_Reader
from OCP.IGESData import IGESData_IGESEntity
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Shape

from wrinkle_cad.cad.exchange.step.text import plain_text
from wrinkle_cad.cad.kernel.steps import KERNEL_ERRORS, kernel_words

from .collect import listed
from .iges_faults import entities_fault, sequence_fault
from .iges_names import entities_of, fields_of, item_names
from .naming import Marker, found_in
from .shapes import CadFile
from .sniff import IGES, Source
from .units import check_unit, unit_words
from .xde import Leaf, kernel_parameters, leaves_of, new_document, silence_kernel

_UNITS: Final = {
    1: "inch",
    2: "mm",
    4: "ft",
    5: "mile",
    6: "m",
    7: "km",
    8: "mil",
    9: "micrometre",
    10: "cm",
    11: "microinch",
}
_NAMED_UNIT: Final = 3
_NAMES: Final = {"IN": "inch", "INCH": "inch", "MM": "mm", "FT": "ft", "M": "m", "CM": "cm"}
_COUNT: Final = re.compile(rb"([SGDP])\s*(\d+)")


def read(source: Source, unit: str | None) -> CadFile:
    """Reads the content of an IGES file.

    Args:
        source: the file.
        unit: refused unless it is the file's own, which IGES always has (inch by default).

    Raises:
        InputError: as for ``read_cad``.
    """
    text = plain_text(source.content)
    _check_records(source, text)
    _fail_on(source, sequence_fault(text))
    entities = dict(entities_of(text))
    _fail_on(source, entities_fault(entities))
    declared = (_declared_unit(text),)
    check_unit(source, declared, unit)
    leaves, number_of = _leaves(source, text)
    shapes = listed(source, found_in(leaves, number_of, item_names(entities)), 1.0)
    if not shapes:
        raise source.fail("no geometry: no curve, face or solid in it. Export it again.")
    words = unit_words(declared, unit)
    return CadFile(source.path, IGES, words, shapes, source.is_compressed, source.sha256)


def _check_records(source: Source, text: bytes) -> None:
    """Compares the records of each section with the counts in the last record."""
    letters = [line[72:73] for line in text.split(b"\n") if len(line) > 72]
    counted = Counter(letters)
    last = [line for line in text.split(b"\n") if line[72:73] == b"T"]
    if not last:
        raise source.fail("truncated: the terminate record is missing. Copy or export it again.")
    for section, count in _COUNT.findall(last[-1][:72]):
        if counted[section] != int(count):
            raise source.fail(
                f"truncated: {counted[section]} records in section {section.decode()},"
                f" {int(count)} are declared. Copy or export it again."
            )


def _declared_unit(text: bytes) -> str:
    lines = [line[:72] for line in text.split(b"\n") if line[72:73] == b"G"]
    fields = _global_fields(b"".join(lines))
    flag = fields[13].strip() if len(fields) > 13 else b""
    number = int(flag) if flag.isdigit() else 1
    if number == _NAMED_UNIT and len(fields) > 14:
        word = fields[14].split(b"H", 1)[-1].strip().decode("ascii", "replace").upper()
        return _NAMES.get(word, word.lower())
    return _UNITS.get(number, "unknown unit")


def _fail_on(source: Source, fault: str | None) -> None:
    if fault is not None:
        raise source.fail(f"damaged: {fault}. Export it again.")


def _global_fields(text: bytes) -> list[bytes]:
    return list(fields_of(text, text[2:3] if text[:2] == b"1H" else b","))


def _leaves(source: Source, text: bytes) -> tuple[list[Leaf], Marker]:
    silence_kernel()
    document = new_document()
    try:
        reader = IGESCAFControl_Reader()
        reader.SetNameMode(True)
        reader.SetColorMode(True)
        # The kernel reads STEP and BREP from memory, but IGES from a file only.
        with tempfile.TemporaryDirectory(prefix="wrinkle-cad-") as folder:
            copy = Path(folder, "input.igs")
            copy.write_bytes(text)
            with kernel_parameters({"xstep.cascade.unit": "MM"}):
                is_read = reader.ReadFile(str(copy)) == IFSelect_RetDone
                is_whole = is_read and reader.Transfer(document)
        if not is_read:
            raise source.fail(
                "damaged: not readable as IGES although its records are whole. Export it again."
            )
        # Every entity is a leaf of its own, and all of them are one part.
        leaves = [replace(leaf, named_at="") for leaf in leaves_of(document)] if is_whole else []
        return leaves, _marker(reader)
    except KERNEL_ERRORS as error:
        raise source.fail(
            f"damaged: the CAD kernel fails on it ({kernel_words(error)}). Export it again."
        ) from error


def _marker(reader: IGESCAFControl_Reader) -> Marker:
    """Returns a function that tells the directory entry that a shape was made from."""

    def number_of(shape: TopoDS_Shape) -> int | None:
        session = reader.WS()
        entity = session.TransferReader().EntityFromShapeResult(
            shape.Located(TopLoc_Location()), -1
        )
        number = session.Model().DNum(entity) if isinstance(entity, IGESData_IGESEntity) else 0
        return number or None

    return number_of
