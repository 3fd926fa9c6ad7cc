"""An end that is asked for from outside ends the program in order, whenever it is asked for."""

from __future__ import annotations

import os
import signal
import sys
import time

import pytest

from wrinkle_cad.cli.signals import ended_in_order


class EndedInItsFinalizer:
    """Gets a signal where Python drops what is raised."""

    def __init__(self, number: signal.Signals) -> None:
        self.number = number

    def __del__(self) -> None:
        os.kill(os.getpid(), self.number)
        for _ in range(1000):
            pass


def wait_for_an_end(number: signal.Signals) -> None:
    with ended_in_order():
        EndedInItsFinalizer(number)
        time.sleep(10.0)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_an_end_that_is_dropped_by_python_is_asked_for_again(number: signal.Signals) -> None:
    before = signal.getsignal(number)
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        wait_for_an_end(number)
    assert time.monotonic() - start < 5.0
    assert signal.getsignal(number) == before
    assert signal.getsignal(signal.SIGTERM) == signal.SIG_DFL


def test_what_else_python_drops_is_told_as_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    class Bad:
        def __del__(self) -> None:
            raise ValueError("told")

    told: list[type[BaseException]] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda dropped: told.append(dropped.exc_type))
    with ended_in_order():
        Bad()
    assert told == [ValueError]
