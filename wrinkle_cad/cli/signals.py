"""An end that is asked for from outside ends the program as Ctrl-C does: in order."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

_ENDING: Final = ("SIGTERM", "SIGHUP")
_AGAIN_S: Final = 0.05
"""s; after which an end is asked for again where the first request was lost."""


@contextmanager
def ended_in_order() -> Iterator[None]:
    """Lets SIGTERM and SIGHUP raise KeyboardInterrupt within the block.

    A signal that is ignored (by ``nohup``) stays ignored. Outside the main thread nothing changes.
    Python drops what is raised while it runs a callback (a finalizer, the bookkeeping of an import)
    and says so on stderr: an end that is asked for at such a moment is asked for again.
    """
    before = {}
    hook = sys.unraisablehook
    for name in _ENDING:
        number = getattr(signal, name, None)
        # Some systems have no SIGHUP.
        if number is None or signal.getsignal(number) != signal.SIG_DFL:
            continue
        try:
            before[number] = signal.signal(number, _interrupt)
        except ValueError:
            break

    def ask_again(dropped: UnraisableHookArgs) -> None:
        if not issubclass(dropped.exc_type, KeyboardInterrupt):
            hook(dropped)
        elif threading.current_thread() is threading.main_thread():
            before.setdefault(signal.SIGTERM, signal.getsignal(signal.SIGTERM))
            signal.signal(signal.SIGTERM, _interrupt)
            again = threading.Timer(_AGAIN_S, _end_main_thread)
            again.daemon = True
            again.start()

    sys.unraisablehook = ask_again
    try:
        yield
    finally:
        sys.unraisablehook = hook
        for number, handler in before.items():
            signal.signal(number, handler)


def _end_main_thread() -> None:
    main = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and main is not None:
        # Wakes it, too, where it waits for the system.
        signal.pthread_kill(main, signal.SIGTERM)
    else:
        _thread.interrupt_main(signal.SIGTERM)


def _interrupt(number: int, _: object) -> None:
    # Once is enough: what cleans up is not interrupted by the next one.
    signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt
