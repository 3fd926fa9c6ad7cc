"""Only regular files of sane size are read, and no reading lasts for ever."""

from __future__ import annotations

import os
import socket
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from wrinkle_cad.errors import InputError
from wrinkle_cad.files.regular import (
    IrregularFileError,
    hash_regular,
    is_regular,
    read_regular,
    within,
)
from wrinkle_cad.files.toml import read_toml


def put_pipe(path: Path) -> Path:
    os.mkfifo(path)
    return path


def put_socket(path: Path) -> Path:
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))
    return path


def put_directory(path: Path) -> Path:
    path.mkdir()
    return path


def put_link(target: str) -> Callable[[Path], Path]:
    def put(path: Path) -> Path:
        path.symlink_to(target)
        return path

    return put


IRREGULAR = {
    "pipe": put_pipe,
    "socket": put_socket,
    "directory": put_directory,
    "endless device": put_link("/dev/zero"),
    "terminal": put_link("/dev/tty"),
    "more than it says": put_link("/proc/self/status"),
    "kernel log": put_link("/proc/kmsg"),
    "dangling link": put_link("nowhere"),
    "link to itself": put_link("a.step"),
    "name with a NUL": lambda path: path.with_name("a\0b"),
    "name of 300 bytes": lambda path: path.with_name("n" * 300),
}


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="devices of Linux")
@pytest.mark.parametrize("kind", IRREGULAR)
@pytest.mark.parametrize("reader", [read_regular, hash_regular])
def test_what_is_no_regular_file_is_refused_at_once(
    tmp_path: Path, kind: str, reader: Callable[..., object]
) -> None:
    path = IRREGULAR[kind](tmp_path / "a.step")
    start = time.monotonic()
    with pytest.raises(OSError, match=r"."):
        reader(path, size_limit=1000)
    assert time.monotonic() - start < 1.0


def test_a_regular_file_is_read_through_a_link_and_hashed(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"abc")
    (tmp_path / "b").symlink_to("a")
    assert read_regular(tmp_path / "b", size_limit=3) == b"abc"
    assert hash_regular(tmp_path / "b").startswith("ba7816bf8f01cfea")
    assert is_regular(tmp_path / "a")
    assert not is_regular(tmp_path / "b")


def test_a_file_above_the_limit_is_refused_with_both_sizes(tmp_path: Path) -> None:
    with (tmp_path / "a").open("wb") as stream:
        stream.truncate(3 * 2**20)
    with pytest.raises(IrregularFileError, match=r"3\.0 MiB large, the limit is 2\.0 MiB"):
        read_regular(tmp_path / "a", size_limit=2 * 2**20)


def test_a_share_that_stalls_is_given_up() -> None:
    def stall(got_on: Callable[[], None]) -> None:
        got_on()
        time.sleep(1.0)

    start = time.monotonic()
    with pytest.raises(TimeoutError, match=r"reading it stalls: nothing for 0\.1 s"):
        within(0.1, stall, "reading it")
    assert time.monotonic() - start < 0.8


def test_a_share_that_is_slow_is_waited_for() -> None:
    def slow(got_on: Callable[[], None]) -> str:
        for _ in range(8):
            time.sleep(0.05)
            got_on()
        return "read"

    assert within(0.2, slow, "reading it") == "read"


def test_an_error_in_the_thread_is_the_callers() -> None:
    def fail(_: Callable[[], None]) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        within(1.0, fail, "reading it")


@pytest.mark.parametrize(
    ("content", "cause"),
    [
        (b"a = " + b"[" * 100_000, "nested too deeply"),
        (b"a = " + b"9" * 5000, "digits"),
        (b"a = \xff", "utf-8"),
        (b"a = ", "Invalid value"),
        (b"#" * 2_000_000, "cannot be read .is 1.9 MiB large"),
    ],
)
def test_hostile_toml_costs_one_sentence(tmp_path: Path, content: bytes, cause: str) -> None:
    path = tmp_path / "job.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=cause) as caught:
        read_toml(path)
    assert str(caught.value).startswith("job.toml")
    assert "\n" not in str(caught.value)
