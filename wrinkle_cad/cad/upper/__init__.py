"""Fig. 11 of the paper: an upper is carved, profiles are drawn, strips are stitched in."""
