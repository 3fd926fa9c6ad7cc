"""The strip in the plane: facets and cones unrolled, and whether the result covers itself."""
