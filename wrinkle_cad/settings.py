"""Every default and tolerance, named once.

The user gives one ``tolerance`` in mm; whatever else is a tolerance is derived from it here.
Lengths are in mm and angles in radians unless a name ends in another unit.
"""

from __future__ import annotations

from typing import Final, Literal, get_args

VERSION: Final = "0.1.0"

TOLERANCE: Final = 0.05
"""mm; how far a chord may lie from its curve when the user says nothing."""

PLANARITY_PER_TOLERANCE: Final = 1e-3
"""A neighbour may lie this share of the chord tolerance on the wrong side of a tangent plane.

Near the chord tolerance itself every bridge would count as valid; at zero, round-off rejects
bridges of exact developables."""

PLANARITY_FLOOR_PER_COORDINATE: Final = 1e-13
"""Planarity is never below this share of the largest coordinate: round-off, times the ratio of
neighbouring spacings that a strip may have."""

ROUND_OFF_PER_COORDINATE: Final = 1.5e-14
"""A distance below this share of the largest coordinate is round-off (64 last places)."""

LARGEST_COORDINATE: Final = 1e9
"""mm; beyond it products of lengths are no longer safe, and the unit is surely wrong."""

STEEPEST_HALF_FOLD: Final = 1e6
"""Tangent of half a fold angle from which a bridge counts as folded back on itself."""

INFLECTION_SAMPLES: Final = 2
"""An inflection bridge is at most this many samples from bridges bent either way."""

INFLECTION_SAGITTAS: Final = 2.0
"""Neighbours share a tangent plane if no further from it than this many typical sagittas."""

DOUBLE_INFLECTION_SAGITTAS: Final = 0.5
"""The same where two changes of bending fall between samples."""

COINCIDENT_SAGITTAS: Final = 0.3
"""Samples this many typical sagittas of the other rail away from it may be of the same curve: a
chord tolerance is a quarter of a sagitta."""

CROSSING_PER_SIZE: Final = 4e-3
"""A strip passes through itself along more than a typical sagitta, or than this share of its size:
rails of points may have any sagitta."""

CREASE_DEG: Final = 5.0
"""A crease of so many degrees is called one."""

STATES: Final = ("developable", "stretched", "creased", "folded")
"""What a verdict may say of a strip, from the best to the worst."""
STRETCH_PERCENT: Final = 0.1
"""A sheet that must give more is called stretched: half of the 0.2 at which sheet metal yields."""

K_FACTOR: Final = 0.5
"""Where a material's neutral layer lies when nothing is known: in the middle."""

TWIST_PER_DEFECT: Final = 0.5
"""A gap is twist, not the end of a fan, if the surface turns by more than this share of the angle
between the rails' tangents."""

SHORTEST_SEGMENT_PER_LENGTH: Final = 1e-6
"""No sampled segment is shorter than this share of its curve's length."""

SURROGATE_PER_TOLERANCE: Final = 1e-3
"""While chords are being placed, polynomials stand for the curve to this share of the tolerance."""

SURROGATE_PER_SIZE: Final = 1e-4
"""... and to this share of the curve's extent, where the tolerance is coarse against the curve."""

TABLE_SAG_PER_TOLERANCE: Final = 3e-3
"""Distances to a chord are measured at points so close that the curve bulges no more than this
share of the tolerance between them."""

SAMPLING_MARGINS: Final = (0.995, 0.98, 0.95, 0.9)
"""Shares of the tolerance that are tried in turn until an independent sampling confirms the chords.

Segments grow as the square root: 0.995 costs a quarter percent of them.
"""

FINEST_TOLERANCE_PER_SIZE: Final = 1e-11
"""A chord tolerance below this share of the largest coordinate would measure round-off."""

UNROLLING_ACCURACY: Final = 1e-11
"""Between samples, polynomials follow a curve to this share of its extent while it is unrolled."""

FLAT_LINE_PER_TOLERANCE: Final = 0.2
"""The flat rails follow their curves to this share of the chord tolerance: chords are shorter than
their curve in proportion to it, and seams are to agree to 1e-4."""

TURNED_BACK_PER_TOLERANCE: Final = 1e-3
"""A curve segment turns back, seen from its apex, if it sweeps this share of the tolerance back."""

Criterion = Literal["invalid", "bending", "area", "length"]
"""What a search can minimise."""
Search = Literal["global", "local"]
"""The exact optimum, or one step ahead at a time."""
Energy = Literal["hinge", "paper"]
"""How bending is measured."""
Ends = Literal["fixed", "free"]
"""Whether a strip has all of its rails, or begins and ends where that is best."""
Surface = Literal["cones", "smooth", "facets"]
"""Faces of a strip: cones whose banks are the exact curves, few smooth ones, planar triangles."""
StepSchema = Literal["AP214", "AP242"]
Unit = Literal["mm", "cm", "m", "inch", "ft"]
"""Units of length that a file may have."""
WaveSide = Literal["out", "in", "both"]
"""The side of an upper on which waves stand."""
WaveKind = Literal["sine", "pleat", "gather"]
"""Even waves, rounded folds that overhang, or such folds of uneven width and height."""

CRITERIA: Final[tuple[Criterion, ...]] = ("invalid", "bending")
"""GODT+GMBT: as many locally convex bridges as possible, then least bending."""

PRICE: Final = 50.0
"""What one invalid bridge more is worth, in mean bending energies of a bridge where the strip bends
least. On 78 strips the last valid bridge to be won cost less than 15, or 21 to 50, or 75 and more:
for the last, a few bridges were bought with folds of over 45 degrees."""

LARGEST_PRICE: Final = 1e6
"""Beyond it a sum of bending and prices would lose what one bridge bends."""

PRICE_SAMPLES: Final = 250
"""The mean bending is taken on rails of at most so many samples; even, so that none is the middle
one."""

SEARCH: Final = "global"
ENERGY: Final = "hinge"
SURFACES: Final = get_args(Surface)
SURFACE: Final = "cones"
STRIP_COLOR: Final = (0.80, 0.52, 0.25)
"""Leather: red, green, blue from 0 to 1."""
BAND_COLOR: Final = (0.88, 0.68, 0.45)
"""Of what joins the wrinkle to the upper: lighter leather."""
UPPER_COLOR: Final = (0.72, 0.72, 0.70)
"""Light grey, so that the wrinkle stands out."""
STEP_SCHEMA: Final = "AP214"

CONFUSION: Final = 1e-7
"""mm; points nearer than this are one point to the CAD kernel (its own fixed constant)."""

LENGTH_ERROR: Final = 1e-9
"""mm; how exactly the CAD kernel integrates the length of an edge."""

AREA_RELATIVE_ERRORS: Final = (1e-8, 1e-6, 1e-4, 1e-2)
"""Tried in turn for the area in a strip's report; a finding tells when it is not the first."""

AREA_SURE: Final = 1e-6
"""An area known no better than this share of it is a finding."""

AREA_RELATIVE_ERROR: Final = 1e-8
"""How exactly the CAD kernel integrates the area of a face; its own default is some 1e-5."""

AREA_ORDERS: Final = (1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-14, 1e-16, 1e-20, 1e-30)
"""Error bounds that make the CAD kernel choose ever higher orders of integration."""

AREA_FIRST_ORDER_PER_ERROR: Final = 500.0
"""The first bound asked for, per relative error wanted: mostly two orders agree far below it."""

PATTERN_CORNER: Final = 0.5
"""rad; the outline of a pattern turns sharper than this at a corner, else it is a curve."""

NOTCH_CLEARANCE: Final = 3.0
"""mm of seam between a notch and the next corner, at least."""

TEXT_HEIGHT: Final = 4.0
"""mm; largest height of the texts in a pattern piece."""

FLAT_FOLD: Final = 1e-7
"""rad; rulings folded by less are neither mountain nor valley."""

NESTING_SECONDS: Final = 0
"""s that each sheet is searched by the clock for a still closer layout."""

PIECE_GAP: Final = 10.0
"""mm between the pieces of one drawing."""

PIECE_SIZE: Final = "M"
"""Size of a piece when the user says nothing; pattern CAD refuses a piece without one."""

DxfVersion = Literal["R12", "R2000", "R2010"]
Curves = Literal["lines", "arcs", "splines"]
"""What curved cut lines are written as in a DXF file."""

DXF_PROFILE: Final = "cutter"
DXF_VERSION: Final = "R2000"

TEST_SQUARE: Final = 100.0
"""mm; side of the square that shows whether a machine read the scale right."""

DXF_DECIMALS: Final = 6
"""Decimals of a coordinate in mm in a pattern file."""

SPAN_SLACK: Final = 1e-9
"""A bridge whose end lies this share of the rail beyond a pattern piece still belongs to it."""

MATRIX_OVERVIEW: Final = 640
"""Pixels on the longer side of the page's overview of a validity matrix, at most."""

MATRIX_TILE: Final = 500
"""Bridges on a side of one tile of a validity matrix in the page."""

MATRIX_TILE_BYTES: Final = 1_000_000
"""Base64 bytes of all tiles of one validity matrix; above, only those at the path are kept."""

RAIL_GAP: Final = 1e-3
"""mm; edges of one rail may end this far apart; their ends are then moved to the middle."""

RAIL_GAP_PER_SIZE: Final = 1e-4
"""... but never further than this share of the largest edge: rails may be microns long."""

RAIL_JUMP: Final = 1e-6
"""Share of the speed by which a curve's derivative must jump at a knot to count as not C1.

Below it is what files lose by writing poles with seven or more digits.
"""

CLOSED_RAIL_CORNER: Final = 0.0175
"""rad; a closed rail that turns by more than this (one degree) at a point has a corner there."""

DEVELOPABLE_SHARE: Final = 0.98
"""The share of its rails that exact rulings cover on a strip that is a developable surface."""

RAIL_LENGTH_MIN: Final = 1e-6
"""mm; a rail must be longer than this."""

RAILS_APART_PER_LENGTH: Final = 1e-6
"""Rails that lie nearer to one another than this share of their length are the same curve."""

COMMON_END_PER_LENGTH: Final = 0.02
"""Rails that meet at an end may run together from there for this share of the shorter one."""

CROSSING_COSINE: Final = 0.9999
"""Rails whose directions are nearer to parallel than this touch rather than cross."""

FILE_SIZE_LIMIT: Final = 256 * 2**20
"""Bytes; the largest file, packed or unpacked, that is handed to the CAD kernel."""

SNIFFED_BYTES: Final = 2**16
"""How far into a file its format is looked for; comments may stand before the mark."""

FILE_UNIT: Final = "mm"
"""The unit of a file that declares none."""

STRIP_NAME: Final = "strip"
"""The name of a strip whose curves do not name it."""

LISTED_SHAPES: Final = 12
"""Candidates that one message lists at most."""

MESH_SAG_PER_TOLERANCE: Final = 0.5
"""The kernel's mesher holds its limit along edges; inside, triangles lie up to 1.7 times as far."""

MESH_ANGLE: Final = 0.2
"""rad; how far the normals of neighbouring triangles of a mesh may differ on a curved face."""

BATCH_TIMEOUT_S: Final = 600.0
"""s; a file of a batch that takes longer is given up."""

COMPILE_PHASE: Final = "compile"
"""What a job is at while functions are compiled, once after an installation."""

BATCH_MEMORY_GIB: Final = 4.0
"""GiB of address space for one worker of a batch."""

BATCH_LEAST_MEMORY_GIB: Final = 2.0
"""GiB; the CAD kernel and numba alone map 1.2, and fail in odd ways just above that."""

BATCH_MEMORY_HIT: Final = 0.85
"""A worker that crashes with more than this share of its memory mapped ran into the limit."""

BATCH_NAME_MASK: Final = "{stem}"
"""Names of a batch's outputs when the user says nothing."""

BATCH_DISK_FREE_MIB: Final = 64
"""MiB; a batch stops when its disk has less left, before files start to fail."""

BATCH_TICK_S: Final = 0.05
"""s between looks at the memory and the time of the workers."""

BATCH_IN_FLIGHT: Final = 64
"""Jobs handed to a caller's own executor at a time."""

BATCH_CLUSTER_IN_FLIGHT: Final = 2000
"""Jobs handed to a Dask cluster at a time, at most."""

BATCH_STARTS: Final = 3
"""A job whose worker is gone before the job begins is handed out this often in all."""

THIN_FACE: Final = 5e-6
"""mm; a face no wider than this is left out: its two long borders become one.

A rail's edge then also stands for the chord beside it, so this bounds how far edges of a strip
can be off their surfaces.
"""

THIN_FACE_PER_SIZE: Final = 5e-7
"""... but no wider than this share of the strip's size. Rails within twice this width meet."""

KNOT_GAP: Final = 1e-9
"""mm; knots of a rail nearer to one another than this are one knot."""

KNOT_TURN: Final = 0.4
"""rad; a cone gets knots until its normal turns by no more than this between two of them."""

KNOT_HALVINGS: Final = 12
"""How often a span of a cone is halved for that, at most."""

PLANE_GAP: Final = 2e-8
"""mm; a curve and an apex within this of one plane make a planar face instead of a cone."""


def planarity_from(tolerance: float) -> float:
    """Returns the planarity in mm that fits a chord tolerance in mm."""
    return PLANARITY_PER_TOLERANCE * tolerance


RAIL_POINTS: Final = 161
"""A rail is laid on the upper at so many points."""

END_POINTS: Final = 25
"""An end of an opening is laid on the upper at so many points."""

WIDTH_PER_LENGTH_MIN: Final = 1e-4
"""Rails nearer to each other than this share of their length enclose no area."""

MEETING_PER_LENGTH: Final = 1e-6
"""Rails whose ends are nearer than this share of their length meet in a point there."""

FADE: Final = 0.3
"""The share of a rail's length over which margin and waves fade in, and out again."""

FADE_MIN: Final = 0.02
"""A shorter fade is a step."""

RAIL_OFF_UPPER: Final = 10.0
"""mm; a rail further away from the upper was not meant for it."""

RAIL_ON_UPPER: Final = 1e-5
"""mm; a rail nearer to the upper lies on it."""

BORDER_REACH_PER_LENGTH: Final = 1e-4
"""A rail that ends nearer to the upper's border than this share of its length ends on it."""

OPENINGS_APART: Final = 0.01
"""mm; openings of one upper must be further from each other: some ten times what is sewn."""

RIBBON_PER_LENGTH: Final = 0.01
"""The ribbons that cut an opening stand out of the upper by this share of the rails' length."""

AREA_BALANCE: Final = 1e-5
"""Relative; by how much the areas of body and removed part may differ from the upper's."""

WAVE_PHASES_DEG: Final = (0.0, 0.0)
"""deg; where the waves of P and Q start in their periods."""

WAVE_SIDE: Final = "out"
"""Wrinkles stand on the outside of the upper."""

WAVES_PER_POINT: Final = 0.125
"""A wave takes at least eight of the points along a rail to be drawn as one."""

GAP_CROSSED: Final = 1e-3
"""mm; edges of one side further apart than this have a gap of the upper between them."""

COINCIDENT: Final = 1e-4
"""mm; a profile nearer to the opening's boundary lies on it, and is sewn without a band."""

SLIVER: Final = 1e-4
"""mm; an end of the opening nearer to the end bridge is sewn to it without a fan."""

SEWING: Final = 1e-3
"""mm; edges nearer to each other than this are sewn; where they were made as one curve they are
some 1e-6 mm apart."""

BAND_FOLD_LIMIT: Final = 2.6
"""rad; a band that turns back on itself by more than this cannot be made or cut."""

EDGE_TOLERANCE_LIMIT: Final = 1e-5
"""mm; what the largest edge tolerance of a stitched shell may be where the upper's own is less."""

SEWN_DIRECTLY: Final = 5e-4
"""mm; a profile that stays nearer to the opening's boundary than this is sewn to it directly."""

BAND_OVERHANG_LIMIT: Final = 0.02
"""The share of a band that may face into the upper; more of it has folded over."""

BAND_CHECKS: Final = 401
"""The width of a band is looked at in so many places."""

BAND_NARROWEST: Final = 5e-3
"""A band that narrows to less than this share of its width between its ends has a slit."""

BAND_LINE: Final = 1025
"""Distances to an opening's side are first looked for on so many points of it."""
