"""One rail: its curve as polynomials, chords to a tolerance, samples."""
