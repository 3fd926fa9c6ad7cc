"""A DXF file from the disk to ezdxf's document: text or binary, mended where ezdxf can.

Whatever is handed in ends in a document or in one sentence: devices and pipes are not opened, files
beyond a size are not read, and blocks that would unfold without end are not unfolded.
"""

from __future__ import annotations

import re
import stat
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final

import ezdxf
from ezdxf import recover
from ezdxf.document import Drawing as DxfDocument
from ezdxf.entities import DXFEntity

from wrinkle_cad.errors import InputError

from . import limits

_BINARY: Final = b"AutoCAD Binary DXF\r\n\x1a\x00"
_ENTITY_START: Final = re.compile(rb"^[ \t]*0[ \t]*\r?$", re.M)
_MIB: Final = 2**20


@dataclass(frozen=True, slots=True, eq=False)
class OpenedDxf:
    """A document and what had to be mended to get it, one sentence each."""

    document: DxfDocument
    """The document."""
    problems: tuple[str, ...]
    """What had to be mended, one sentence each."""


def open_dxf(path: Path) -> OpenedDxf:
    """Opens a DXF file of any release, text or binary.

    Raises:
        InputError: it is no file that can be read, too large, or no DXF.
    """
    content = _content(path)
    is_binary = content.startswith(_BINARY)
    if b"SECTION" not in content:
        raise InputError(f"{path.name} has no DXF section in it. Check what kind of file it is.")
    _check_amount(content, path.name, is_binary=is_binary)
    is_small = _is_within(content, limits.MOST_TO_MEND, is_binary=is_binary)
    is_whole = content.rstrip(b"\r\n\t \0\x1a").endswith(b"EOF")
    del content
    try:
        document, auditor = _loaded(path, may_mend=is_small and not is_binary)
    except MemoryError:
        # That is the limit's, not the file's: whoever set the limit says so.
        raise
    # ezdxf raises some twenty classes of errors, bare ones of Python among them, from broken files.
    except Exception as error:
        raise InputError(
            f"{path.name} is no DXF that can be read ({type(error).__name__}). Export it again."
        ) from error
    problems = [] if is_whole else ["The file has no EOF at its end: it was cut off."]
    problems += [f"{error.message}." for error in (*auditor.errors, *auditor.fixes)]
    return OpenedDxf(document, tuple(problems))


def _check_amount(content: bytes, name: str, *, is_binary: bool) -> None:
    """Raises InputError for more than can be read in a bearable time and memory."""
    if not _is_within(content, 1.0, is_binary=is_binary):
        raise InputError(
            f"{name} holds more than {limits.MOST_ENTITIES:,} lines, marks and vertices, or as "
            "much in another form. Export its pieces in several files."
        )


def _is_within(content: bytes, share: float, *, is_binary: bool) -> bool:
    """Whether a file's content is within a share of the limits."""
    if is_binary:
        return len(content) <= share * limits.BINARY_LIMIT
    most = int(share * limits.MOST_ENTITIES)
    starts = islice(_ENTITY_START.finditer(content), most + 1)
    return content.count(b"\n") <= share * 2 * limits.MOST_TAGS and sum(1 for _ in starts) <= most


def _loaded(path: Path, *, may_mend: bool) -> tuple[DxfDocument, Any]:
    """Reads a file; one that is not sound is read again by the slower reader that mends."""
    try:
        document = ezdxf.filemanagement.readfile(str(path))
        auditor = document.audit()
        if not (may_mend and (auditor.errors or auditor.fixes)):
            return document, auditor
    except Exception:
        # Of any class, see above; the reader that mends meets the same and raises it again.
        if not may_mend:
            raise
    document, auditor = recover.readfile(path)
    return document, auditor


def _content(path: Path) -> bytes:
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"{path.name} is not a regular file. Give the path of a DXF file.")
        if status.st_size > limits.FILE_LIMIT:
            raise InputError(
                f"{path.name} has {status.st_size / _MIB:.0f} MiB. At most "
                f"{limits.FILE_LIMIT // _MIB} are read: export its pieces in several files."
            )
        content = path.read_bytes()
    except OSError as error:
        raise InputError(
            f"{path.name} cannot be read ({error.strerror}). Check the path."
        ) from error
    if not content.strip():
        raise InputError(f"{path.name} is empty. Export it again.")
    return content


def check_unfolding(document: DxfDocument, name: str) -> None:
    """Raises InputError where the drawing's blocks would unfold without end.

    Args:
        document: its model space is what would be unfolded.
        name: of the file.

    Raises:
        InputError: blocks insert each other in a circle, are nested too deeply, or make too many
            entities.
    """
    counts: dict[str, int] = {}
    # A stack instead of recursion: files may nest blocks by the thousand.
    path: list[tuple[str, list[tuple[str, int]], int]] = []
    open_blocks: set[str] = set()

    def entered(key: str, entities: Iterable[DXFEntity]) -> None:
        own, children = _parts(entities)
        path.append((key, children, own))
        open_blocks.add(key)
        if len(path) > limits.DEEPEST_BLOCKS:
            raise InputError(
                f"{name} nests blocks more than {limits.DEEPEST_BLOCKS} deep. Explode "
                "them in the program that wrote the file."
            )

    entered("", document.modelspace())
    while path:
        key, children, own = path.pop()
        missing = next((child for child, _ in children if child not in counts), None)
        if missing is None:
            open_blocks.discard(key)
            # The model space's own entities are as many as the file has room for.
            total = (own if key else 0) + sum(
                copies * (1 + counts[child]) for child, copies in children
            )
            counts[key] = min(total, limits.MOST_UNFOLDED + 1)
            continue
        path.append((key, children, own))
        if missing in open_blocks:
            raise InputError(
                f"{name} has a block, {missing!a}, that contains itself. Remove that insertion."
            )
        entered(missing, document.blocks.get(missing) or ())
    if counts[""] > limits.MOST_UNFOLDED:
        raise InputError(
            f"{name} makes more than {limits.MOST_UNFOLDED:,} lines, marks and vertices where its "
            "blocks are inserted. Remove insertions, or export the pieces in several files."
        )


def _parts(entities: Iterable[DXFEntity]) -> tuple[int, list[tuple[str, int]]]:
    """Returns how much is drawn as it is, and the blocks inserted, with copies."""
    own = 0
    children = []
    for entity in entities:
        inserted = list(_inserted(entity))
        children += inserted
        own += 0 if inserted else _amount(entity)
    return own, children


def _amount(entity: DXFEntity) -> int:
    """Returns how many vertices an entity states, 1 at least."""
    kind = entity.dxftype()
    if kind == "LWPOLYLINE":
        return max(1, len(entity))
    if kind == "POLYLINE":
        return max(1, len(entity.vertices))
    return max(1, len(entity.control_points), len(entity.fit_points)) if kind == "SPLINE" else 1


def _inserted(entity: DXFEntity) -> Iterator[tuple[str, int]]:
    if entity.dxftype() == "INSERT":
        # ezdxf gives a count of 0 or less as the file has it.
        rows = max(1, int(entity.dxf.get("row_count", 1)))
        columns = max(1, int(entity.dxf.get("column_count", 1)))
        yield str(entity.dxf.get("name", "")).lower(), rows * columns
    elif entity.dxf.hasattr("geometry"):
        yield str(entity.dxf.geometry).lower(), 1
