"""The exact surface of a strip: rulings from the curves themselves, in ordered pieces.

- *Ruling*: a segment from a point of P to one of Q. Along an exact one the surface has one tangent
  plane, which both rails' tangents lie in: `det(P', Q', Q - P) = 0`.
- *Twist* `phi`: the angle between the tangent planes at a ruling's two ends; 0 on an exact one.
- *Pairing*: which point of Q each point of P is joined to, in order; *least twist* (`pairing`).
- *Way*: how a pairing goes on: a ruled stretch, or a fan about a point of P or of Q.
- *Interval*: what lies between a ruling and the next.
- *Piece*: a run of intervals of one kind: torsal, cone, plane, gap (`pieces`).
- *Sheet*: the tangent planes along the rulings (`sheet`).

The bridges of a triangulation say near which rulings to look; nothing else is taken from it, so
that what is found does not depend on how the rails were sampled. `rule_strip` does all of it, and
`rule_closed_strip` that of a strip without ends.

What is not handled: rails whose tangent lies along a ruling for a stretch (no plane is spanned, the
twist counts as 0).
"""
