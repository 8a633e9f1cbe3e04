"""The command line `vibrostage`: all programs under one name, and commands that belong to no single rig."""

from rigkit.program import Program

PACKAGES = "vibrostage", "calibration", "vibractl", "stagectl", "firmware_sim"
STUDY = Program(
    "Run any command over plants, seeds and settings, on every core or a cluster.",
    {
        "example": "vibrostage.study_example:example_command",
        "run": "vibrostage.study_command:run_command",
        "replay": "vibrostage.study_command:replay_command",
        "report": "vibrostage.study_results:report_command",
        "compare": "vibrostage.study_results:compare_command",
    },
    PACKAGES,
)
PROGRAM = Program(
    "Learning control for marine vibrators, piezo stages and the robots beside them: all programs in one.",
    {"plan": "stagectl.commands.plan_command:plan"},
    PACKAGES,
    {
        "vibrator": "vibractl.application:PROGRAM",
        "stage": "stagectl.application:STAGE",
        "cell": "stagectl.application:CELL",
        "calibrate": "calibration.application:PROGRAM",
        "sim": "firmware_sim.application:PROGRAM",
        "study": "vibrostage.application:STUDY",
    },
)
