"""The command line `firmware-sim`: its commands, each in a module of its own."""

from rigkit.program import Program

PROGRAM = Program(
    "Simulated vibrator, stage and robot cell behind real interfaces, and from WAV to WAV.",
    {
        "play": "vibractl.foreign.play_command:play_command",
        "draw": "firmware_sim.draw_command:draw_command",
        "vibrator": "firmware_sim.vibrator_command:vibrator_command",
        "stage": "firmware_sim.stage_command:stage_command",
        "robot": "firmware_sim.robot_command:robot_command",
        "relay": "firmware_sim.relay_command:relay_command",
    },
    ("firmware_sim", "stagectl", "vibractl"),
)
