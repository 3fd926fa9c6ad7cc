"""Where a drawing's contours stand: in the model space, in its plane, on layers that are shown."""

from __future__ import annotations

from collections.abc import Iterator

from wrinkle_cad.errors import Finding

from .reading import DxfContent


def judge_space(content: DxfContent, cut_layers: frozenset[str]) -> Iterator[Finding]:
    """Yields contours that a cutter would not see, or would see mirrored.

    Args:
        content: of the file.
        cut_layers: in lower case.
    """
    hidden = {layer.lower() for layer in content.hidden_layers}
    for layer in content.layers:
        if layer.lower() in hidden & cut_layers:
            yield Finding(
                "layer-off",
                "error",
                f"Cut layer {layer} is switched off or frozen; some programs then leave it out. "
                "Switch it on.",
            )
    for layer in content.paper_layers:
        if layer.lower() in cut_layers:
            yield Finding(
                "paper-space",
                "error",
                f"A line on cut layer {layer} stands in a paper space. Cutters read the model "
                "space: move it there.",
            )
    for kind, layer in content.turned:
        if layer.lower() in cut_layers:
            yield Finding(
                "extrusion",
                "error",
                f"{kind} on cut layer {layer} has an extrusion other than (0, 0, 1); programs "
                "that do not read it cut its mirror image. Draw it in the plane, seen from above.",
            )
