"""Ducts as shops make them, with their exact areas."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from build123d import Edge, Ellipse, Pos, Rectangle, Rot, Wire
from scipy.integrate import quad

Vector = np.ndarray


@dataclass(frozen=True)
class Family:
    name: str
    p: object
    q: object
    area: float
    p_length: float
    q_length: float
    is_polyhedral: bool = False


def between_parallels(first: Callable, second: Callable, low: float, high: float) -> float:
    """Area of rulings between points of two curves with parallel tangents.

    Each returns a point, a unit tangent and a speed.
    """

    def element(at: float) -> float:
        (a, t, speed), (b, _, other) = first(at), second(at)
        way = b - a
        return 0.5 * (speed + other) * float(np.linalg.norm(way - (way @ t) * t))

    return quad(element, low, high, epsabs=1e-11, epsrel=1e-12, limit=400)[0]


def circle_at(radius: float, centre: tuple[float, float, float]) -> Callable:
    def at(phi: float):
        u = np.array([math.cos(phi), math.sin(phi), 0.0])
        return np.array(centre) + radius * u, np.array([-u[1], u[0], 0.0]), radius

    return at


def ellipse_at(a: float, b: float, z: float) -> Callable:
    """By the direction of its normal."""

    def at(phi: float):
        c, s = math.cos(phi), math.sin(phi)
        size = math.hypot(a * c, b * s)
        place = np.array([a * a * c / size, b * b * s / size, z])
        return place, np.array([-s, c, 0.0]), a * a * b * b / size**3

    return at


def triangle(*corners) -> float:
    a, b, c = (np.array(corner, dtype=float) for corner in corners)
    return 0.5 * float(np.linalg.norm(np.cross(b - a, c - a)))


def corner_cone(corner, radius: float, h: float, low: float, high: float) -> float:
    """The cone from a corner in z = 0 over an arc of the circle at h."""
    apex = np.array([*corner, 0.0])

    def element(phi: float) -> float:
        u = np.array([math.cos(phi), math.sin(phi), 0.0])
        way = radius * u + np.array([0, 0, h]) - apex
        return 0.5 * float(np.linalg.norm(np.cross(way, radius * np.array([-u[1], u[0], 0.0]))))

    return quad(element, low, high, epsabs=1e-11, epsrel=1e-12)[0]


def round_edge(radius: float, z: float = 0.0, x: float = 0.0) -> Edge:
    return Pos(x, 0, z) * Edge.make_circle(radius)


def oval(large: float, straight: float) -> Wire:
    return Wire(
        [
            Edge.make_line((-straight / 2, -large, 0), (straight / 2, -large, 0)),
            Pos(straight / 2, 0, 0) * Edge.make_circle(large, start_angle=-90, end_angle=90),
            Edge.make_line((straight / 2, large, 0), (-straight / 2, large, 0)),
            Pos(-straight / 2, 0, 0) * Edge.make_circle(large, start_angle=90, end_angle=270),
        ]
    )


def dee(large: float) -> Wire:
    return Wire(
        [
            Edge.make_circle(large, start_angle=-90, end_angle=90),
            Edge.make_line((0, large, 0), (0, -large, 0)),
        ]
    )


def reducer(r1: float, r2: float, h: float, shift: float) -> float:
    return between_parallels(circle_at(r1, (0, 0, 0)), circle_at(r2, (shift, 0, h)), 0, 2 * math.pi)


def rect_to_round(a: float, b: float, r: float, h: float) -> float:
    sides = 2 * triangle((a, b, 0), (-a, b, 0), (0, r, h)) + 2 * triangle(
        (a, b, 0), (a, -b, 0), (r, 0, h)
    )
    return sides + 4 * corner_cone((a, b), r, h, 0, math.pi / 2)


def ellipse_length(a: float, b: float) -> float:
    return quad(
        lambda t: math.hypot(a * math.sin(t), b * math.cos(t)),
        0,
        2 * math.pi,
        epsabs=1e-12,
        epsrel=1e-13,
        limit=400,
    )[0]


def tilted_area(r1, r2, h, tilt) -> float:
    """Rulings with a common tangent plane, found by Newton, area by quadrature."""
    c, s = math.cos(tilt), math.sin(tilt)

    def q(v):
        return np.array([r2 * math.cos(v) * c, r2 * math.sin(v), h - r2 * math.cos(v) * s])

    def dq(v):
        return np.array([-r2 * math.sin(v) * c, r2 * math.cos(v), r2 * math.sin(v) * s])

    def p(u):
        return np.array([r1 * math.cos(u), r1 * math.sin(u), 0])

    def dp(u):
        return np.array([-r1 * math.sin(u), r1 * math.cos(u), 0])

    from scipy.optimize import brentq

    def f(u, v):
        return float(np.cross(dp(u), dq(v)) @ (q(v) - p(u)))

    def v_of(u):
        return brentq(lambda v: f(u, v), u - 0.6, u + 0.6, xtol=1e-14, rtol=8.9e-16)

    def element(u):
        v = v_of(u)
        e = 1e-5
        rate = (v_of(u + e) - v_of(u - e)) / (2 * e)
        way = q(v) - p(u)
        length = np.linalg.norm(way)
        e1 = way / length
        a, b = dp(u), dq(v) * rate
        ha = np.linalg.norm(a - (a @ e1) * e1)
        hb = np.linalg.norm(b - (b @ e1) * e1)
        return 0.5 * (ha + hb) * length

    return quad(element, 0, 2 * math.pi, epsabs=1e-6, epsrel=1e-10, limit=400)[0]


def families() -> list[Family]:
    tau = 2 * math.pi
    large, r, h = 60.0, 40.0, 90.0
    alpha = math.radians(15)

    def gore(sign, z):
        e = Ellipse(50 / math.cos(alpha), 50).wire().edges()[0]
        return Pos(0, 0, z) * Rot(0, sign * 15, 0) * e

    return [
        Family("cylinder", round_edge(50), round_edge(50, 60), tau * 50 * 60, tau * 50, tau * 50),
        Family(
            "cone",
            round_edge(50),
            round_edge(30, 80),
            math.pi * 80 * math.hypot(20, 80),
            tau * 50,
            tau * 30,
        ),
        Family(
            "oblique cone",
            round_edge(large),
            round_edge(r, h, 35),
            reducer(large, r, h, 35),
            tau * large,
            tau * r,
        ),
        Family(
            "square to round",
            Rectangle(200, 200).wire(),
            round_edge(50, 150),
            89_811.953498,
            800,
            tau * 50,
        ),
        Family(
            "rectangle to round",
            Rectangle(200, 120).wire(),
            round_edge(50, 150),
            rect_to_round(100, 60, 50, 150),
            640,
            tau * 50,
        ),
        Family(
            "oval to round",
            oval(40, 100),
            round_edge(50, 120),
            2
            * between_parallels(
                circle_at(40, (50, 0, 0)), circle_at(50, (0, 0, 120)), -math.pi / 2, math.pi / 2
            )
            + 2 * triangle((-50, 40, 0), (50, 40, 0), (0, 50, 120)),
            tau * 40 + 200,
            tau * 50,
        ),
        Family(
            "eccentric reducer",
            round_edge(large),
            round_edge(r, h, large - r),
            reducer(large, r, h, large - r),
            tau * large,
            tau * r,
        ),
        Family(
            "tilted reducer",
            round_edge(large),
            Pos(0, 0, h) * Rot(0, 20, 0) * Edge.make_circle(r),
            tilted_area(large, r, h, math.radians(20)),
            tau * large,
            tau * r,
        ),
        Family(
            "elbow gore",
            gore(1, 0),
            gore(-1, 80),
            tau * 50 * 80,
            ellipse_length(50 / math.cos(alpha), 50),
            ellipse_length(50 / math.cos(alpha), 50),
        ),
        Family(
            "hopper",
            Rectangle(200, 140).wire(),
            Pos(0, 0, 120) * Rectangle(80, 60).wire(),
            280 * math.hypot(120, 40) + 200 * math.hypot(120, 60),
            680,
            280,
            True,
        ),
        Family(
            "circle to ellipse",
            round_edge(50),
            Pos(0, 0, 100) * Ellipse(70, 30).wire().edges()[0],
            between_parallels(circle_at(50, (0, 0, 0)), ellipse_at(70, 30, 100), 0, tau),
            tau * 50,
            ellipse_length(70, 30),
        ),
        Family(
            "D to round",
            dee(60),
            round_edge(40, 100),
            between_parallels(
                circle_at(60, (0, 0, 0)), circle_at(40, (0, 0, 100)), -math.pi / 2, math.pi / 2
            )
            + 2 * corner_cone((0, 60), 40, 100, math.pi / 2, math.pi)
            + triangle((0, 60, 0), (0, -60, 0), (-40, 0, 100)),
            math.pi * 60 + 120,
            tau * 40,
        ),
    ]
