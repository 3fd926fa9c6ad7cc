"""STEP, BREP and IGES files -> named shapes in mm.

Bytes first, kernel second: the file is read and judged before the kernel is imported. Coordinates
are world coordinates (placements of assemblies applied). Not read: triangulations, drawings,
layers, materials.
"""

from __future__ import annotations

from pathlib import Path

from wrinkle_cad import settings
from wrinkle_cad.cad.kernel.loading import kernel_importable
from wrinkle_cad.errors import InputError

from .shapes import CadFile
from .sniff import BREP, IGES, STEP, read_source
from .units import MM_PER_UNIT


def read_cad(
    path: Path, *, unit: str | None = None, size_limit: int = settings.FILE_SIZE_LIMIT
) -> CadFile:
    """Reads every shape of a CAD file that can be chosen as a directrix or as an upper.

    Args:
        path: a STEP, BREP or IGES file, whatever it is called; it may be compressed with gzip.
        unit: ``mm``, ``cm``, ``m``, ``inch`` or ``ft``: the unit of a file that declares none
            (BREP never does); such a file is in mm when this is None.
        size_limit: bytes; larger files are refused before the kernel sees them.

    Returns:
        The shapes in the file's order, in mm. Faces and shells of one product are one item.

    Raises:
        InputError: the file cannot be read; the message names the true cause. Also if ``unit``
            contradicts what the file declares.
        CadError: the kernel cannot be loaded.

    Example:
        >>> from build123d import Edge
        >>> from wrinkle_cad import Part, write_step
        >>> p = Edge.make_line((0, 0), (90, 0))
        >>> write_step(Path("rail.step"), [Part(p.wrapped, "P")])
        >>> read_cad(Path("rail.step")).shapes[0].measure
        90.0
    """
    if unit is not None and unit not in MM_PER_UNIT:
        raise InputError(f"The unit is {unit!r}. Choose one of {', '.join(MM_PER_UNIT)}.")
    source = read_source(Path(path), size_limit=size_limit)
    with kernel_importable():
        from . import read_brep, read_iges, read_step
    readers = {STEP: read_step.read, BREP: read_brep.read, IGES: read_iges.read}
    return readers[source.format](source, unit)
