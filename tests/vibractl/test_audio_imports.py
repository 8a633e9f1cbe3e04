"""The audio process imports what streams and guards, however the program was started."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.vibractl.linear_rig import linear_model

ROOT = Path(__file__).parents[2]
PROGRAM = "import sys\nfrom {name}.__main__ import main\nif __name__ == '__main__':\n    sys.exit(main())\n"
"""As pip installs it."""
ELSEWHERE = {
    *("can", "fastapi", "google.protobuf", "h5py", "httpx", "jinja2", "matplotlib", "platformdirs"),
    *("prometheus_client", "pyfftw", "rich", "serial", "soundfile", "threadpoolctl", "typer", "uvicorn"),
    *("websocket", "websockets"),
    *("scipy.fft", "scipy.optimize", "scipy.signal", "scipy.sparse", "scipy.special"),
    *("vibractl.learner", "vibractl.session", "vibractl.application", "calibration.application"),
}


@pytest.mark.sample(1)
@pytest.mark.parametrize("name", ["vibractl", "calibration"])
def test_the_audio_process_imports_nothing_that_belongs_to_the_program(tmp_path: Path, name: str) -> None:
    program, log = tmp_path / "program.py", tmp_path / "modules.json"
    program.write_text(PROGRAM.format(name=name))
    arguments = ["--out", str(tmp_path / "out.h5"), "--set", "simulator.plant=tests.vibractl.module_log:ModuleLog"]
    arguments += ["--set", f"simulator.options.file={log}"]
    wanted = ["vibrator"] if name == "calibration" else ["run", "--model", str(linear_model(tmp_path))]
    done = subprocess.run(
        [sys.executable, program, *wanted, *arguments],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "the modules are written down" in done.stderr
    imported = set(json.loads(log.read_text()))
    assert "vibractl.guard_kernel" in imported
    assert ELSEWHERE & imported == set()


@pytest.mark.parametrize("name", ["vibractl", "calibration", "stagectl"])
def test_a_process_that_a_program_starts_imports_its_script_for_nothing(name: str) -> None:
    code = f"import sys; before = set(sys.modules); import {name}.__main__; print(*(set(sys.modules) - before))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert set(done.stdout.split()) <= {name, f"{name}.__main__"}
