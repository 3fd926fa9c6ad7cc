"""CAD files in and out: STEP, IGES, BREP, STL; names, colors and units."""
