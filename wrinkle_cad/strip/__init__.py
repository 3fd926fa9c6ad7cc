"""The mathematics of a strip: arrays in, frozen results out; no CAD."""
