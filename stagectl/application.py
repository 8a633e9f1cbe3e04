"""The command line `stagectl`: its commands, each in a module of its own."""

from rigkit.program import Program
from stagectl.experiments import registry

PROGRAM = Program(
    "Piezo stage and robot cell: control, learning, planning, reports.",
    {
        "example-config": "stagectl.commands.example_commands:example_config",
        "example-cell": "stagectl.commands.example_commands:example_cell",
        "example-pocket": "stagectl.commands.example_commands:example_pocket",
        **{each.name: each.command for each in registry.EXPERIMENTS},
        "plan": "stagectl.commands.plan_command:plan",
        "robot-files": "stagectl.commands.robot_files_command:robot_files",
        "estimate-force": "stagectl.robot.milling.force_command:estimate_force_command",
        "replay": "stagectl.commands.replay_command:replay_command",
        "report": "stagectl.commands.report_command:report_command",
        "export": "stagectl.commands.export:export",
        "doctor": "stagectl.doctor.command:doctor_command",
        "prune": "rigkit.retention_command:prune_command",
        "acknowledge": "stagectl.commands.acknowledge_command:acknowledge_command",
        "daemon": ("stagectl.daemon.command:daemon_command", "rigkit.service.daemon_command:daemon_command"),
        "status": "rigkit.service.command:status_command",
        "stop": "rigkit.service.command:stop_command",
    },
    ("stagectl", "firmware_sim"),
)
_BOTH = ("replay", "report", "export", "doctor", "prune", "daemon", "status", "stop")
STAGE = PROGRAM.part(
    "The piezo stage.", "example-config", *(each.name for each in registry.STAGE), "acknowledge", *_BOTH
)
CELL = PROGRAM.part(
    "The robot cell.",
    "example-cell",
    "example-pocket",
    *(each.name for each in registry.CELL),
    "plan",
    "estimate-force",
    "robot-files",
    *_BOTH,
)
