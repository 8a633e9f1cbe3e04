"""The command line `vibrostage`: groups of commands that belong to no single rig."""

from rigkit.program import Program

PROGRAM = Program(
    "What goes beyond one rig: studies over many machines, on every core or a cluster.",
    {"study": "vibrostage.study_command:study_app"},
    ("vibrostage", "calibration", "vibractl", "stagectl"),
)
