"""The CAD kernel behind small functions: the one place that knows OCP's versions."""
