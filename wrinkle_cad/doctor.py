"""What is wrong with an installation, in plain words, and what to do about it."""

from __future__ import annotations

import ctypes
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Final

PYTHON_FROM: Final = (3, 11)
PYTHON_BELOW: Final = (3, 14)
BUILD123D_SERIES: Final = ("0.12", "0.13")
KERNEL_IMPORT_SECONDS: Final = 120.0

_SYSTEM_LIBRARIES: Final = {"libGL.so.1": "libgl1", "libX11.so.6": "libx11-6"}
_KERNEL_WHEELS: Final = ("cadquery-ocp", "cadquery-ocp-novtk")


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """The outcome of one check."""

    name: str
    """What was looked at."""
    is_ok: bool
    """Whether it is as it must be."""
    message: str
    """What was found and, when it is not as it must be, what to do."""


def diagnose(environment: Mapping[str, str]) -> tuple[Diagnosis, ...]:
    """Looks at everything that the package needs; changes nothing and raises nothing.

    Args:
        environment: the environment variables of the process.
    """
    return (
        diagnose_python(sys.version_info[:2]),
        *(
            diagnose_library(name, package, ctypes.CDLL)
            for name, package in _SYSTEM_LIBRARIES.items()
            if sys.platform.startswith("linux")
        ),
        diagnose_wheels(_installed_version),
        diagnose_build123d(_installed_version("build123d")),
        diagnose_kernel(sys.executable),
        diagnose_cache(_numba_cache_folders(environment)),
    )


def diagnose_python(version: tuple[int, ...]) -> Diagnosis:
    """Whether a (major, minor) version of Python is supported."""
    found = ".".join(str(part) for part in version)
    if PYTHON_FROM <= version < PYTHON_BELOW:
        return Diagnosis("Python", True, f"{found} ({platform.python_implementation()})")
    return Diagnosis(
        "Python", False, f"{found}: make the virtual environment with Python 3.11 to 3.13."
    )


def diagnose_library(name: str, package: str, load: Callable[[str], object]) -> Diagnosis:
    """Whether a shared library of the system can be loaded."""
    try:
        load(name)
    except OSError:
        advice = (
            f"missing, and the CAD kernel needs it: install it (Debian: apt-get install {package})."
        )
        return Diagnosis(name, False, advice)
    return Diagnosis(name, True, "found")


def diagnose_wheels(version_of: Callable[[str], str | None]) -> Diagnosis:
    """Whether the installed OCP wheels fit each other: all of them write the same folder."""
    found = {wheel: version for wheel in _KERNEL_WHEELS if (version := version_of(wheel))}
    listed = ", ".join(f"{wheel} {version}" for wheel, version in found.items())
    if not found:
        return Diagnosis(
            "OCP wheels", False, "none is installed: pip install --upgrade wrinkle-cad"
        )
    if len({_series(version) for version in found.values()}) > 1:
        advice = (
            f"{listed} overwrite each other. Only one series works: in a fresh environment install "
            "either wrinkle-cad or wrinkle-cad[cadquery] (build123d below 0.13)."
        )
        return Diagnosis("OCP wheels", False, advice)
    return Diagnosis("OCP wheels", True, listed)


def diagnose_build123d(version: str | None) -> Diagnosis:
    """Whether the installed build123d is one that the package is tested with."""
    if version is None:
        return Diagnosis("build123d", False, "not installed: pip install 'build123d>=0.12,<0.14'")
    if _series(version) not in BUILD123D_SERIES:
        advice = f"{version}, and only 0.12 and 0.13 work: pip install 'build123d>=0.12,<0.14'"
        return Diagnosis("build123d", False, advice)
    return Diagnosis("build123d", True, version)


def diagnose_kernel(python: str) -> Diagnosis:
    """Whether the CAD kernel loads, tried in a process of its own since it may abort."""
    code = "import OCP, OCP.BRep, OCP.STEPCAFControl; print(OCP.__version__)"
    try:
        tried = subprocess.run(
            [python, "-c", code],
            capture_output=True,
            text=True,
            timeout=KERNEL_IMPORT_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Diagnosis("CAD kernel", False, f"did not load within {KERNEL_IMPORT_SECONDS:.0f} s")
    if tried.returncode == 0:
        return Diagnosis("CAD kernel", True, f"OCP {tried.stdout.strip()} loads")
    last = (tried.stderr.strip().splitlines() or [f"exit code {tried.returncode}"])[-1]
    return Diagnosis(
        "CAD kernel",
        False,
        f"does not load: {last}. See the lines above, else reinstall in a fresh environment.",
    )


def diagnose_cache(folders: tuple[Path, ...]) -> Diagnosis:
    """Whether compiled code can be kept: numba writes to the first folder that it may."""
    for folder in folders:
        if _is_writable(folder):
            return Diagnosis("compile cache", True, str(folder))
    advice = (
        f"no writable folder among {', '.join(str(folder) for folder in folders)}: every start "
        "compiles anew, up to a minute. Set NUMBA_CACHE_DIR to a writable folder."
    )
    return Diagnosis("compile cache", False, advice)


def _installed_version(distribution: str) -> str | None:
    try:
        return metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return None


def _series(version: str) -> str:
    return ".".join(version.split(".")[:2])


def _numba_cache_folders(environment: Mapping[str, str]) -> tuple[Path, ...]:
    # numba's order: NUMBA_CACHE_DIR, then beside the source, then the user's cache folder.
    chosen = environment.get("NUMBA_CACHE_DIR")
    if chosen:
        return (Path(chosen),)
    home = environment.get("XDG_CACHE_HOME") or str(Path("~/.cache").expanduser())
    return (Path(__file__).parent / "strip" / "__pycache__", Path(home) / "numba")


def _is_writable(folder: Path) -> bool:
    existing = next((path for path in (folder, *folder.parents) if path.exists()), Path())
    try:
        with tempfile.TemporaryFile(dir=existing):
            return True
    except OSError:
        return False
