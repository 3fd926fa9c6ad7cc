"""What every strip in the package has in common, whoever made it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from wrinkle_cad.strip.curve.sampling import Samples

    from .triangulation import Triangulation


class SampledStrip(Protocol):
    """A strip between two sampled rails."""

    @property
    def name(self) -> str:
        """What messages, pieces and files call it."""

    @property
    def p_samples(self) -> Samples:
        """The samples of its rail P."""

    @property
    def q_samples(self) -> Samples:
        """The samples of its rail Q."""

    @property
    def triangulation(self) -> Triangulation:
        """The strip itself."""
