"""The command line `calibrate`: its commands, each in a module of its own."""

import typer

from rigkit.lazy_commands import Commands, program

PURPOSE = "Experiments that end in a model file."
COMMANDS: Commands = {
    "vibrator": "calibration.vibrator_command:vibrator_command",
    "compare": "calibration.compare_command:compare_command",
    "identify": "calibration.identification.command:identify_command",
    "stage": "calibration.stage_axes.command:stage_command",
    "hysteresis": "calibration.hysteresis_command:hysteresis_command",
    "joints": "calibration.joint_clamping.command:joints_command",
    "velocity": "calibration.milling.velocity_command:velocity_command",
    "milling": "calibration.milling.command:milling_command",
}


def application(called: str | None = None) -> typer.Typer:
    """Make the command line; of its commands only the one that is `called` is imported, or all."""
    return program(PURPOSE, COMMANDS, called)
