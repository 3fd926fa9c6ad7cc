"""The phases of one run: which one is on, how long each took."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from wrinkle_cad.settings import COMPILE_PHASE

from .outcome import Progress


class PhaseClock:
    """Times the phases of a run and tells a listener about them.

    Args:
        progress: the listener; nobody when None.
        total: how many phases there will be.
    """

    def __init__(self, progress: Progress | None, total: int) -> None:
        self._progress = progress
        self._total = total
        self._done = 0
        self.current = "start"
        self.seconds: dict[str, float] = {}

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Counts the block as one phase; a phase that comes again adds up."""
        self.current = name
        self._tell(name)
        start = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start
        self._done = min(self._done + 1, self._total)
        self._tell(name)

    def tell_compiling(self, is_under_way: bool) -> None:
        """Tells the listener that functions are compiled, then that the phase goes on."""
        self._tell(COMPILE_PHASE if is_under_way else self.current)

    def _tell(self, name: str) -> None:
        if self._progress is not None:
            self._progress(name, self._done, self._total)
