"""One batch per folder."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

from wrinkle_cad.batch.folder.lock import LOCK_NAME, locked_folder
from wrinkle_cad.errors import InputError

HOLD = """
import sys, time
from pathlib import Path
from wrinkle_cad.batch.folder.lock import locked_folder
with locked_folder(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


def test_a_second_batch_is_refused_until_the_first_is_gone(tmp_path: Path) -> None:
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    assert holder.stdout.readline() == "held\n"
    with pytest.raises(InputError, match=f"process {holder.pid}"), locked_folder(tmp_path):
        pass
    holder.kill()
    holder.wait()
    holder.stdout.close()
    start = time.monotonic()
    with locked_folder(tmp_path):
        pass
    assert time.monotonic() - start < 2


def test_a_lock_file_that_was_left_behind_holds_nothing(tmp_path: Path) -> None:
    (tmp_path / LOCK_NAME).write_text("wrinkle_cad lock, process 999999999\n")
    with locked_folder(tmp_path):
        held = (tmp_path / LOCK_NAME).read_text()
    assert "999999999" not in held


def test_a_system_without_such_locks_is_told_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "fcntl", None)
    with pytest.raises(InputError, match="locks of Linux or macOS"), locked_folder(tmp_path):
        pass
