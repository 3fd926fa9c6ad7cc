"""Two-dimensional: what goes to the cutter. No CAD kernel in this folder."""
