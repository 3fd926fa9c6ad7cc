"""What a CAD file is, told from its first bytes before the kernel sees it.

A file's name is not believed: a STEP file may be compressed under the name ``.step``, and a page
saved from a web site is called ``.stp`` as well. Only the standard library is needed here, so the
bytes are in memory before the kernel's 0.7 s import begins.
"""

from __future__ import annotations

import hashlib
import re
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from wrinkle_cad import settings
from wrinkle_cad.errors import InputError
from wrinkle_cad.files.regular import IrregularFileError, read_regular

STEP: Final = "STEP"
BREP: Final = "BREP"
IGES: Final = "IGES"

_GZIP = b"\x1f\x8b"
_MOST_MEMBERS: Final = 100_000
_FIRST_CHUNK: Final = 512
_LAST_CHUNK: Final = 1 << 20
_POINTER = b"version https://git-lfs.github.com/spec/"
_BREP_HEAD = re.compile(rb"\s*(DBRep_DrawableShape|CASCADE Topology V|Open CASCADE Topology V)")
# Atomic: without it, many comments before something else take time exponential in their number.
_STEP_HEAD = re.compile(rb"(?:\s|(?>/\*.*?\*/))*+ISO-10303-21\s*;", re.DOTALL)
_IGES_HEAD = re.compile(rb"[^\r\n]{72}[SF]\s*0*1\s*[\r\n]")
_MARKS = (
    (b"\xef\xbb\xbf", "utf-8-sig"),
    (b"\xff\xfe", "utf-16"),
    (b"\xfe\xff", "utf-16"),
)
_STRANGERS = (
    (re.compile(rb"PK\x03\x04"), "a ZIP archive, to be unpacked first"),
    (re.compile(rb"\s*<(!DOCTYPE\s+html|html)", re.I), "a web page instead of the file itself"),
    (re.compile(rb"\s*(<\?xml[^>]*>\s*)?<[\w:]*iso_10303_28", re.I), "STEP as XML (part 28)"),
    (re.compile(rb"%PDF-"), "a PDF"),
    (re.compile(rb"solid\b.*facet", re.DOTALL), "an STL mesh, which has no exact curves"),
    (re.compile(rb"\s*0\s+SECTION\s"), "a DXF drawing"),
    (re.compile(rb"BZh|\xfd7zXZ|7z\xbc\xaf|Rar!|\x28\xb5\x2f\xfd"), "compressed, but not by gzip"),
)


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """The bytes of one CAD file and what they are."""

    path: Path
    """Where they came from."""
    format: str
    """``STEP``, ``BREP`` or ``IGES``."""
    content: bytes
    """The file's bytes, decompressed, without a byte order mark."""
    is_compressed: bool
    """Whether the file was compressed with gzip, whatever it is called."""
    sha256: str = ""
    """Of the file as it is stored: 64 hexadecimal digits."""

    def fail(self, found: str) -> InputError:
        """Returns the error that names this file and, if it was compressed, says so."""
        note = " (the file is gzip-compressed and was unpacked)" if self.is_compressed else ""
        return InputError(f"Cannot read {self.path.name}{note}: {found}")


def read_source(path: Path, *, size_limit: int = settings.FILE_SIZE_LIMIT) -> Source:
    """Reads a file and tells its format from its content.

    Args:
        path: the file.
        size_limit: bytes; the largest file, and the largest unpacked content, that is read.

    Returns:
        Its unpacked content and format.

    Raises:
        InputError: the file cannot be read, is empty, is above the limit, is a git-LFS pointer or
            none of STEP, BREP and IGES.
    """
    packed = _read(path, size_limit)
    is_compressed = packed.startswith(_GZIP)
    content = _unpack(path, packed, size_limit) if is_compressed else packed
    content = _without_mark(content)
    if not content.strip():
        raise InputError(
            f"Cannot read {path.name}: the file is empty. Export it again from its CAD."
        )
    if content.startswith(_POINTER):
        raise InputError(
            f"Cannot read {path.name}: a git-LFS pointer file, the CAD file itself was never"
            " fetched. Run 'git lfs pull' where it came from."
        )
    digest = hashlib.sha256(packed).hexdigest()
    return Source(path, _format_of(path, content), content, is_compressed, digest)


def _read(path: Path, size_limit: int) -> bytes:
    try:
        return read_regular(path, size_limit=size_limit)
    except IrregularFileError as error:
        raise InputError(
            f"Cannot read {path.name}: it {error.strerror}. Name a STEP, BREP or IGES file."
        ) from error
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"Cannot read {path.name}: {reason}. Check the path.") from error


def _too_large(path: Path, found: str, size_limit: int) -> InputError:
    return InputError(
        f"Cannot read {path.name}: {found} large, the limit is {size_limit / 2**20:.1f} MiB."
        " Export only the curves and the upper, or raise the limit."
    )


def _unpack(path: Path, packed: bytes, size_limit: int) -> bytes:
    """Unpacks every member of a gzip file, never more than the limit."""
    content = bytearray()
    at = members = 0
    try:
        while packed.startswith(_GZIP, at):
            members += 1
            if members > _MOST_MEMBERS:
                raise InputError(
                    f"Cannot read {path.name}: more than {_MOST_MEMBERS} gzip files in one. Unpack"
                    " it first."
                )
            stream = zlib.decompressobj(wbits=zlib.MAX_WBITS | 16)
            step = _FIRST_CHUNK
            while not stream.eof:
                chunk = packed[at : at + step]
                content += stream.decompress(chunk, size_limit + 1 - len(content))
                if len(content) > size_limit:
                    raise _too_large(
                        path, f"more than {size_limit / 2**20:.1f} MiB unpacked", size_limit
                    )
                if not chunk:
                    raise InputError(
                        f"Cannot read {path.name}: gzip-compressed and cut short after"
                        f" {len(packed)} bytes. Copy or download the file again."
                    )
                at += len(chunk) - len(stream.unused_data)
                # From a few bytes on: many small members must not cost a long chunk each.
                step = min(2 * step, _LAST_CHUNK)
    except zlib.error as error:
        raise InputError(
            f"Cannot read {path.name}: gzip-compressed and damaged ({error}). Copy the file again."
        ) from error
    return bytes(content)


def _without_mark(content: bytes) -> bytes:
    """Removes a byte order mark; text in UTF-16 becomes UTF-8."""
    for mark, encoding in _MARKS:
        if content.startswith(mark):
            try:
                return content.decode(encoding).encode()
            except UnicodeDecodeError:
                return content[len(mark) :]
    return content


def _format_of(path: Path, content: bytes) -> str:
    head = content[: settings.SNIFFED_BYTES]
    if _STEP_HEAD.match(head):
        return STEP
    if _BREP_HEAD.match(head):
        return BREP
    if _IGES_HEAD.match(head):
        return IGES
    for pattern, what in _STRANGERS:
        if pattern.match(head):
            raise InputError(f"Cannot read {path.name}: not STEP, BREP or IGES: {what}.")
    start = " ".join(head[:40].decode("ascii", "replace").split())
    shown = "".join(letter if letter.isprintable() else "?" for letter in start)
    raise InputError(
        f"Cannot read {path.name}: not a STEP, BREP or IGES file: {len(content)} bytes that start"
        f" with '{shown}'. Export the curves as STEP."
    )
