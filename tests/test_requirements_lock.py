"""The lock file of a shop's install: everything pinned, by hash, and what pyproject.toml allows."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parent.parent
LOCK = ROOT / ".ci" / "requirements.lock"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PYTHONS = ("3.11", "3.12", "3.13")
PLATFORMS = ("linux", "darwin", "win32")


def entries() -> list[tuple[Requirement, list[str]]]:
    """The requirements of the lock file, each with its hashes."""
    joined = LOCK.read_text().replace("\\\n", " ")
    lines = [line.strip() for line in joined.splitlines()]
    found = []
    for line in lines:
        if line and not line.startswith("#"):
            text, *hashes = re.split(r"\s--hash=", line)
            found.append((Requirement(text.strip()), [each.strip() for each in hashes]))
    return found


def environment(python: str, platform: str) -> dict[str, str]:
    return {
        "python_version": python,
        "python_full_version": f"{python}.0",
        "sys_platform": platform,
        "platform_system": {"linux": "Linux", "darwin": "Darwin", "win32": "Windows"}[platform],
    }


def test_every_package_is_pinned_and_has_hashes_and_no_address() -> None:
    for requirement, hashes in entries():
        assert [each.operator for each in requirement.specifier] == ["=="], str(requirement)
        assert requirement.url is None
        assert hashes, str(requirement)
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}", each) for each in hashes)
    assert "://" not in LOCK.read_text()
    assert "--index" not in LOCK.read_text()


@pytest.mark.parametrize("platform", PLATFORMS)
@pytest.mark.parametrize("python", PYTHONS)
def test_the_lock_satisfies_what_the_package_and_its_build_need(python: str, platform: str) -> None:
    here = environment(python, platform)
    locked: dict[str, Requirement] = {}
    for requirement, _ in entries():
        if requirement.marker is None or requirement.marker.evaluate(here):
            name = canonicalize_name(requirement.name)
            assert name not in locked, f"{name} twice on {python}, {platform}"
            locked[name] = requirement
    wanted = [*PROJECT["project"]["dependencies"], *PROJECT["build-system"]["requires"]]
    for text in wanted:
        needed = Requirement(text)
        (pin,) = locked[canonicalize_name(needed.name)].specifier
        assert needed.specifier.contains(pin.version), f"{text}: locked is {pin.version}"


def test_every_python_that_is_named_is_allowed_and_no_other() -> None:
    from packaging.specifiers import SpecifierSet

    allowed = SpecifierSet(PROJECT["project"]["requires-python"])
    assert [f"3.{minor}" for minor in range(9, 17) if f"3.{minor}.0" in allowed] == list(PYTHONS)
    named = {line.rpartition(" ")[2] for line in PROJECT["project"]["classifiers"] if "3." in line}
    assert named == set(PYTHONS)


def test_every_dependency_has_an_upper_bound() -> None:
    extras = PROJECT["project"]["optional-dependencies"]
    for_users = [text for name in ("cadquery", "cluster", "nesting") for text in extras[name]]
    for text in (*PROJECT["project"]["dependencies"], *for_users):
        operators = {each.operator for each in Requirement(text).specifier}
        assert operators & {"<", "<=", "==", "~="}, text
