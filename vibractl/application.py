"""The command line `vibractl`: its commands, each in a module of its own."""

from rigkit.program import Program

PROGRAM = Program(
    "The marine vibrator learns, shot by shot, to emit the reference and nothing else.",
    {
        "example-config": "vibractl.example_command:example_config",
        "run": "vibractl.run_command:run_command",
        "replay": "vibractl.replay_command:replay_command",
        "report": "vibractl.report_command:report_command",
        "judge": "vibractl.foreign.judge_command:judge_command",
        "import": "vibractl.foreign.import_command:import_command",
        "step": "vibractl.foreign.step_command:step_command",
        "predict": "vibractl.predict.command:predict_command",
        "library": "vibractl.library.command:library_app",
        "export": "vibractl.export.command:export_command",
        "prune": "rigkit.retention_command:prune_command",
        "doctor": "vibractl.doctor.command:doctor_command",
        "devices": "vibractl.devices_command:devices_command",
        "plan-ffts": "vibractl.fft_command:plan_command",
        "daemon": ("vibractl.daemon.command:daemon_command", "rigkit.service.daemon_command:daemon_command"),
        "status": "rigkit.service.command:status_command",
        "stop": "rigkit.service.command:stop_command",
    },
    ("vibractl",),
)
