"""The ring of CAD around the mathematics: the only folder that imports OCP or build123d."""
