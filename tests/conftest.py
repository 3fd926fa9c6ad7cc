"""Options and fixtures that every test folder shares."""

from __future__ import annotations

import shutil
import signal
from pathlib import Path

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--realdata",
        metavar="DIR",
        default=None,
        help="folder with real CAD files; tests marked realdata are skipped without it",
    )


def pytest_configure() -> None:
    # A shell starts what it runs in the background with Ctrl-C ignored, and tests press it.
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if config.getoption("--realdata") is None:
        skip = pytest.mark.skip(reason="no --realdata DIR given")
        for item in items:
            if "realdata" in item.keywords:
                item.add_marker(skip)


@pytest.fixture(scope="session")
def realdata(request: pytest.FixtureRequest) -> Path:
    """The folder with real CAD files."""
    folder = Path(request.config.getoption("--realdata"))
    assert folder.is_dir(), f"--realdata {folder} is not a folder"
    return folder


@pytest.fixture(scope="session")
def freecadcmd() -> str:
    """FreeCAD's command line program; its absence is a failure."""
    program = shutil.which("freecadcmd") or shutil.which("FreeCADCmd")
    assert program is not None, "freecadcmd is not installed (Debian: freecad-python3)"
    return program
