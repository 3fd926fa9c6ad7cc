"""An end that is asked for from outside ends the program as Ctrl-C does: in order."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

_ENDING: Final = ("SIGTERM", "SIGHUP")


@contextmanager
def ended_in_order() -> Iterator[None]:
    """Lets SIGTERM and SIGHUP raise KeyboardInterrupt within the block.

    A signal that is ignored (by ``nohup``) stays ignored. Outside the main thread nothing changes.
    """
    before = {}
    for name in _ENDING:
        number = getattr(signal, name, None)
        # Some systems have no SIGHUP.
        if number is None or signal.getsignal(number) != signal.SIG_DFL:
            continue
        try:
            before[number] = signal.signal(number, _interrupt)
        except ValueError:
            break
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _interrupt(number: int, _: object) -> None:
    # Once is enough: what cleans up is not interrupted by the next one.
    signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt
