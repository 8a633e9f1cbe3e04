"""The command line `calibrate`: its commands, each in a module of its own."""

from rigkit.program import Program

PROGRAM = Program(
    "Experiments that end in a model file.",
    {
        "vibrator": "calibration.vibrator_command:vibrator_command",
        "compare": "calibration.compare_command:compare_command",
        "identify": "calibration.identification.command:identify_command",
        "response": "calibration.frequency_domain.command:response_command",
        "stage": "calibration.stage_axes.command:stage_command",
        "hysteresis": "calibration.hysteresis_command:hysteresis_command",
        "joints": "calibration.joint_clamping.command:joints_command",
        "velocity": "calibration.milling.velocity_command:velocity_command",
        "milling": "calibration.milling.command:milling_command",
    },
    ("calibration", "vibractl", "stagectl", "firmware_sim"),
)
