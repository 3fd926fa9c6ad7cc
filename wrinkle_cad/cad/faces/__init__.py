"""A triangulation becomes a shell: planes and cones between shared edges."""
