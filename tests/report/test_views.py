"""What the page draws is where it is in space."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.report.strips import cylinder_rails, dome, view_of, wavy_rails
from wrinkle_cad.report.views import MeshView, scene_payload


def numbers(text: str, kind: str = "<f4") -> NDArray[Any]:
    return np.frombuffer(base64.b64decode(text), dtype=kind)


def body_points(packed: dict[str, Any], center: NDArray[np.float64]) -> NDArray[np.float64]:
    share = numbers(packed["points"], "<u2").reshape(-1, 3) / 65535.0
    return np.asarray(packed["low"]) + share * np.asarray(packed["span"]) + center


@pytest.mark.parametrize("offset", [0.0, 2.0e5])
def test_samples_lose_nothing_that_can_be_seen_far_from_the_origin(offset: float) -> None:
    p, q = cylinder_rails()
    view = view_of((p + offset, q + offset))
    payload = scene_payload([view], None)
    center = np.asarray(payload["center"])
    for key, rail in (("p", p), ("q", q)):
        shown = numbers(payload["strips"][0][key]).reshape(-1, 3) + center
        assert np.abs(shown - rail - offset).max() < 1e-5


@pytest.mark.parametrize("side", [40, 300])
def test_a_body_is_shown_to_a_few_micrometres(side: int) -> None:
    body = dome(side)
    payload = scene_payload([view_of(cylinder_rails())], body)
    packed = payload["body"]
    shown = body_points(packed, np.asarray(payload["center"]))
    assert np.abs(shown - body.vertices).max() < 0.005
    assert packed["wide"] == (len(body.vertices) > 2**16)
    faces = numbers(packed["faces"], "<u4" if packed["wide"] else "<u2").reshape(-1, 3)
    assert np.array_equal(faces, body.faces)


def test_a_flat_or_empty_body_can_be_shown() -> None:
    view = view_of(cylinder_rails())
    flat = dome(4).vertices * np.array([1.0, 1.0, 0.0], dtype=np.float32)
    payload = scene_payload([view], MeshView("flat", flat, dome(4).faces))
    shown = body_points(payload["body"], np.asarray(payload["center"]))
    assert np.abs(shown - flat).max() < 0.005
    empty = MeshView("none", np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32))
    assert scene_payload([view], empty)["body"]["points"] == ""


def test_paths_and_measures_are_those_of_the_triangulations() -> None:
    view = view_of(wavy_rails(40, 44))
    packed = scene_payload([view], None)["strips"][0]
    assert view.local is not None
    assert view.least_bending is not None
    for key, strip in (
        ("chosen", view.triangulation),
        ("local", view.local),
        ("least", view.least_bending),
    ):
        assert np.array_equal(numbers(packed[key]["steps"], "u1"), strip.steps)
        assert np.array_equal(numbers(packed[key]["valid"], "u1"), strip.valid)
        assert np.allclose(numbers(packed[key]["fold"]), strip.fold, rtol=1e-6, atol=1e-12)
        assert np.allclose(numbers(packed[key]["bending"]), strip.bending_at, rtol=1e-6)
    assert np.array_equal(numbers(packed["inflection"], "u1"), view.triangulation.inflection)
    assert np.allclose(numbers(packed["twist"]), view.triangulation.twist, rtol=1e-6, atol=1e-12)


def test_without_strips_there_is_still_a_scene() -> None:
    scene = scene_payload([], None)
    assert scene["center"] == [0.0, 0.0, 0.0]
    assert scene["strips"] == []
    assert scene["body"] is None
