"""What the check calls short, near, large and too much."""

from __future__ import annotations

from typing import Final

ZERO: Final = 1e-6
"""mm; a DXF file's segments shorter than this have no length, ends closer than this meet."""

HAIR: Final = 0.1
"""mm; contours that lie closer than this to each other all around are one, drawn twice; laser
software merges points at the same distance."""

SHORTEST: Final = 0.01
"""mm; shorter segments make a machine stutter."""

FILE_LIMIT: Final = 32 * 2**20
"""Bytes; the largest DXF file that is judged: reading takes some 35 times as much memory."""

BINARY_LIMIT: Final = FILE_LIMIT // 3
"""Bytes of the largest binary one, which says more in fewer bytes."""

MOST_ENTITIES: Final = 60_000
"""Lines, points, texts and vertices of a file that is read: as many take five seconds."""

MOST_TAGS: Final = 1_000_000
"""Pairs of lines of its text, likewise."""

MOST_TO_MEND: Final = 0.5
"""The share of both that a broken file may have: it is read twice, and mending is the slower."""

MOST_UNFOLDED: Final = 50_000
"""Lines, marks and vertices that a drawing's blocks may make where they are inserted."""

MOST_CURVE_POINTS: Final = 400_000
"""Points that a file's curves may be taken apart to."""

MOST_FIT_POINTS: Final = 1_000
"""Points that a spline without controls may pass through: ezdxf solves for all at once."""

DEEPEST_BLOCKS: Final = 100
"""So many blocks may be nested in each other."""

MOST_PAIRS: Final = 20_000
"""Pairs of lines that meet, or of contours, are looked at until there are so many."""

MOST_COMPARED: Final = 2_000_000
"""Vertices of lines with overlapping boxes that are compared while looking for these pairs."""

NEAR_MISS: Final = 1.0
"""mm; free ends closer than this were meant to meet."""

SMALLEST: Final = 2.0
"""mm; a drawing smaller than this was probably written in another unit."""

LARGEST: Final = 20_000.0
"""mm; a drawing larger than this was probably written in another unit."""
