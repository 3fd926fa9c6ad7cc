"""Room on the disk."""

from __future__ import annotations

from pathlib import Path

import pytest

from wrinkle_cad.batch.folder.disk_space import check_disk_space
from wrinkle_cad.errors import ExportError


def test_enough_room_passes(tmp_path: Path) -> None:
    check_disk_space(tmp_path, least_mib=0)


def test_too_little_room_is_told_with_the_figures(tmp_path: Path) -> None:
    with pytest.raises(ExportError, match=r"\d+ MiB free, at least 1000000000000 MiB"):
        check_disk_space(tmp_path, least_mib=10**12)
