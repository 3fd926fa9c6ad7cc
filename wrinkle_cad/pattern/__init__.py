"""The flat pattern: what goes to the cutter; no CAD."""
