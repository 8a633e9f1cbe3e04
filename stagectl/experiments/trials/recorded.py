"""What is recorded of a trial: which signals, at which rates, under which names."""

from stagectl.devices.signals import Signal

RATE = 2_000.0
"""ticks/s, of the graph: robot, tracker and cut."""
SLOW = 8
"""Ticks between two samples of the robot port."""
FOLLOW = 0.4
"""s from the beginning, from which on the robot follows: it has been heard by then."""

TORQUE = Signal("torque", "torque", "N m", 6)
"""What the drives say."""
LOGGED = (Signal("torque_stamp", "torque_stamp", "s", 1), Signal("logged_torque", "logged_torque", "N m", 6))
"""The same over a line of its own, by the times of that line from the first report on."""
FORCE = (
    Signal("wrench", "wrench", "1", 6),
    Signal("force_sample", "force_sample", "1", 1),
    Signal("force_status", "force_status", "1", 1),
)
"""What the force sensor says."""
REFERENCE = Signal("reference", "port.reference", "rad", 6)
FELT = Signal("felt", "felt.force", "N")
MADE = {
    "trial": (
        Signal("correction", "path.correction", "rad", 6),
        REFERENCE,
        Signal("holding", "port.holding", "1", 1),
        Signal("retreating", "path.retreating", "1", 1),
        FELT,
    ),
    "tracker": (Signal("tool_seen", "seen.workpiece_position"),),
}
"""What the controllers make of it, by recording."""
NOMINAL = Signal("nominal", "path.nominal", "rad", 6)
SENT = Signal("sent", "path.sent")
TRUTH = (Signal("position", "position"), Signal("force", "force", "N"))
"""What nobody but the simulator knows."""
EVERY = {"trial": SLOW, "tracker": 1, "truth": SLOW}
"""Ticks between two samples, by recording."""
