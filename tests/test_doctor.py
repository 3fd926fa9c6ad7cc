from __future__ import annotations

import os
import sys
from pathlib import Path

from wrinkle_cad.doctor import (
    diagnose,
    diagnose_build123d,
    diagnose_cache,
    diagnose_kernel,
    diagnose_library,
    diagnose_python,
    diagnose_wheels,
)


def refuse(name: str) -> object:
    raise OSError(f"{name}: cannot open shared object file")


def test_this_installation_is_sound() -> None:
    problems = [found for found in diagnose(os.environ) if not found.is_ok]
    assert not problems


def test_a_missing_library_names_the_package_that_brings_it() -> None:
    found = diagnose_library("libGL.so.1", "libgl1", refuse)
    assert not found.is_ok
    assert "apt-get install libgl1" in found.message
    assert diagnose_library("libGL.so.1", "libgl1", lambda name: name).is_ok


def test_wheels_of_two_series_clash() -> None:
    versions = {"cadquery-ocp": "7.9.3.1.1", "cadquery-ocp-novtk": "8.0.1.0"}
    found = diagnose_wheels(versions.get)
    assert not found.is_ok
    assert "7.9.3.1.1" in found.message
    assert "8.0.1.0" in found.message


def test_wheels_of_one_series_go_together() -> None:
    versions = {"cadquery-ocp": "7.9.3.1.1", "cadquery-ocp-novtk": "7.9.3.1"}
    assert diagnose_wheels(versions.get).is_ok


def test_no_wheel_at_all_is_a_problem() -> None:
    assert not diagnose_wheels({}.get).is_ok


def test_unsupported_versions_are_told_with_the_supported_ones() -> None:
    assert diagnose_python((3, 11)).is_ok
    assert diagnose_python((3, 13)).is_ok
    for version in ((3, 10), (3, 14)):
        found = diagnose_python(version)
        assert not found.is_ok
        assert "3.11 to 3.13" in found.message
    assert diagnose_build123d("0.12.1").is_ok
    assert diagnose_build123d("0.13.0").is_ok
    assert not diagnose_build123d("0.14.0").is_ok
    assert not diagnose_build123d(None).is_ok


def test_a_kernel_that_does_not_load_is_a_problem(tmp_path: Path) -> None:
    assert diagnose_kernel(sys.executable).is_ok
    broken = tmp_path / "python"
    broken.write_text("#!/bin/sh\necho 'ImportError: libGL.so.1: no such file' >&2\nexit 1\n")
    broken.chmod(0o755)
    found = diagnose_kernel(str(broken))
    assert not found.is_ok
    assert "libGL.so.1" in found.message


def test_no_writable_cache_is_a_problem(tmp_path: Path) -> None:
    assert diagnose_cache((tmp_path / "new",)).is_ok
    # Nothing can be made below a device, not even by root.
    found = diagnose_cache((Path("/dev/null/cache"),))
    assert not found.is_ok
    assert "NUMBA_CACHE_DIR" in found.message
