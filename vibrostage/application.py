"""The command line `vibrostage`: all programs under one name, and commands that belong to no single rig."""

from rigkit.program import Program

PROGRAM = Program(
    "Learning control for marine vibrators, piezo stages and the robots beside them: all programs in one.",
    {"plan": "stagectl.commands.plan_command:plan", "study": "vibrostage.study_command:study_app"},
    ("vibrostage", "calibration", "vibractl", "stagectl", "firmware_sim"),
    {
        "vibrator": "vibractl.application:PROGRAM",
        "stage": "stagectl.application:STAGE",
        "cell": "stagectl.application:CELL",
        "calibrate": "calibration.application:PROGRAM",
        "sim": "firmware_sim.application:PROGRAM",
    },
)
