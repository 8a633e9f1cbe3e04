"""Planners by name."""

PLANNERS = ("exact", "sequential", "qlearning", "features", "uncertain")
"""Those that plan on the rates of the pocket."""
UNTRAINED = ("sequential", "uncertain")
"""Those that can do without."""
