"""What is recorded of force-controlled milling: which signals, under which names."""

from stagectl.devices.signals import Signal

SLOW = 8
"""Ticks between two samples of everything but robot and cut."""
FORCE = (
    Signal("sample", "sample", "1", 1),
    Signal("status", "status", "1", 1),
    Signal("measured", "measured", "1", 6),
)
"""What the force sensor says."""
TRUE = (
    Signal("tool", "tool"),
    Signal("true_force", "true_force", "N"),
    Signal("true_kappa", "true_kappa", "m/(N s)", 1),
    Signal("true_beta", "true_beta", "1", 1),
)
"""What only a simulated cell knows."""
MOVED = (
    Signal("number", "segments.number", "1", 1),
    Signal("cut", "segments.cut", "1", 2),
    Signal("place", "move.place"),
    Signal("direction", "move.direction", "1", 2),
    Signal("is_running", "move.is_running", "1", 1),
    Signal("is_finished", "move.is_finished", "1", 1),
    Signal("duration", "move.duration", "s", 1),
    Signal("force_deviation", "move.force_deviation", "N", 1),
    Signal("force", "judged.force", "N"),
    Signal("valid", "judged.valid", "1", 1),
    Signal("along", "seen.along", "N", 2),
    Signal("feed", "control.reference", "m/s", 1),
    Signal("resultant", "control.resultant", "N", 1),
    Signal("phase", "control.phase", "1", 1),
    Signal("reference", "port.reference", "rad", 6),
    Signal("holding", "port.holding", "1", 1),
)
"""What is made of it, whoever controls the feed."""
ADAPTED = (
    Signal("wanted", "control.wanted", "m/s", 1),
    Signal("estimated", "control.estimated", "m/s", 1),
    Signal("kappa", "control.kappa", "m/(N s)", 1),
    Signal("kappa_deviation", "control.kappa_deviation", "m/(N s)", 1),
    Signal("beta", "control.beta", "1", 1),
    Signal("beta_deviation", "control.beta_deviation", "1", 1),
    Signal("notice", "control.notice", "1", 1),
    Signal("ripple", "control.ripple", "Hz", 1),
)
"""And what force control adds."""


def made(control: str) -> tuple[Signal, ...]:
    """Return the signals that the graph makes, under "force" or "position" control."""
    return (*MOVED, *ADAPTED) if control == "force" else MOVED
