"""The flags of the command ``batch``; light, since every command line loads it."""

from __future__ import annotations

import argparse
from pathlib import Path

from wrinkle_cad import settings


def add_batch_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the flags that only a batch has; those of a job are added by the caller."""
    add = parser.add_argument
    add("inputs", nargs="*", metavar="INPUT", help="files, folders, glob patterns")
    add("--name", metavar="MASK", help="names of the outputs: {stem} {suffix} {folder} {number}")
    add("--job", type=Path, metavar="FILE.toml", help="settings for files without their own")
    add("--workers", type=_whole_number, metavar="N", help="processes at a time (one per core)")
    add_limit_arguments(parser)
    add("--force", action="store_true", help="do again what is done already")
    add("--dry-run", action="store_true", help="say what would be done, write nothing")
    add("--failed", action="store_true", help="list what failed in -o DIR, and why; do nothing")
    add(
        "--scheduler",
        metavar="ADDRESS",
        help="run on an existing Dask cluster; it is trusted as this machine is: results are Python"
        " objects, and whoever sends them can run code here",
    )
    add(
        "--ship-bytes",
        action="store_true",
        help="with --scheduler: its workers share no folder with this machine",
    )
    for flag, what in (
        ("--tls-ca", "certificates that vouch for the scheduler"),
        ("--tls-cert", "this machine's certificate"),
        ("--tls-key", "its key"),
    ):
        add(flag, type=Path, metavar="FILE.pem", help=f"with --scheduler tls://...: {what}")
    output = parser.add_mutually_exclusive_group()
    output.add_argument("--quiet", action="store_true", help="print failures only")
    output.add_argument("--json-lines", action="store_true", help="print one JSON value per line")


def add_limit_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds the limits of one file's job."""
    add = parser.add_argument
    add(
        "--timeout",
        type=_number,
        metavar="S",
        help=f"seconds for one file ({settings.BATCH_TIMEOUT_S:g})",
    )
    add(
        "--memory",
        type=_number,
        metavar="GIB",
        help=f"address space for one file in GiB ({settings.BATCH_MEMORY_GIB:g};"
        f" at least {settings.BATCH_LEAST_MEMORY_GIB:g})",
    )


def _number(text: str) -> float:
    """A number; argparse puts the flag before the sentence."""
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"cannot be {text[:40]!r}: give a number.") from None


def _whole_number(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"cannot be {text[:40]!r}: give a whole number.") from None
