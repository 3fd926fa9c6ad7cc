"""A rail from whatever a caller holds: edges in a row, a directrix, points at arc lengths."""
