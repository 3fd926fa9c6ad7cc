"""Pieces as files: DXF in every profile, SVG, PDF."""
