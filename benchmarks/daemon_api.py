"""Let schemathesis try a daemon's API while the rig works, and look at the answers and at the rig.

`python -m benchmarks.daemon_api vibractl|stagectl [SECONDS]`, with schemathesis on PATH (pip install schemathesis).
The vibrator is the simulated one in real time, calibrated and learning; the stage is simulated, and holds a position.
Whenever a STOP has come through, the rig is armed again and goes on.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rigkit.run_folder import read_quality
from rigkit.service.client import Client, DaemonError
from rigkit.service.config import Daemon
from tests.rigkit.service.served import ROOT, Served, answers, free_port
from tests.stagectl.daemon.bench import lab_in
from tests.until import until

SECONDS = 300.0
CHECKS = (
    "not_a_server_error,status_code_conformance,content_type_conformance,response_headers_conformance,"
    "response_schema_conformance,unsupported_method,allow_header_conformance,ignored_auth"
)
LOOK = 0.5
"""s between two looks at the rig."""
BEGUN: dict[str, tuple[str, dict[str, Any]]] = {
    "vibractl": ("run", {"shots": 1000, "reference": "chirp:40:90:1"}),
    "stagectl": ("hold", {"seconds": 600.0}),
}


@contextmanager
def daemon_of(program: str, folder: Path) -> Iterator[Served]:
    """Start a daemon of either rig, ready to be armed."""
    table = Daemon(address=f"127.0.0.1:{free_port()}", data=str(folder / "data"), requests=1000.0)
    own = [f"daemon.{name}={getattr(table, name)}" for name in ("address", "data", "requests")]
    if program == "vibractl":
        (folder / "data").mkdir()
        model = str(folder / "data" / "model.h5")
        calibrate = [sys.executable, "-m", "calibration", "vibrator", "--out", model]
        subprocess.run(calibrate, cwd=ROOT, check=True, capture_output=True)
        file, own = None, [*own, "simulator.speed=1.0"]
    else:
        lab = lab_in(folder)
        lab.close()
        file = lab.file
    config = ["--config", str(file)] if file else []
    settings = [f"--set={setting}" for setting in own]
    process = subprocess.Popen([sys.executable, "-m", program, "daemon", *config, *settings], cwd=ROOT)
    made = Served(table, process)
    try:
        until(lambda: answers(made), 180)
        yield made
    finally:
        process.terminate()
        process.wait(60)


def keep_going(client: Client, program: str, number: int) -> bool:
    """Arm and begin again where a STOP has come through; say whether that was done."""
    if client.snapshot()["state"]["name"] not in ("DISARMED", "ARMED"):
        return False
    procedure, options = BEGUN[program]
    try:
        with client.control("bench", over=True):
            if client.snapshot()["state"]["name"] == "DISARMED":
                client.command("arm", "to be tried")
            client.begin(procedure, run=f"run-{number}", **options)
    except DaemonError:
        return False  # another STOP, or somebody else's control: the next look sees to it
    return True


def ordinary() -> None:
    """Let the tester have no more than an ordinary priority, whatever this benchmark was started with."""
    os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))


def main(program: str, seconds: float) -> int:
    """Try it, and print what was found; the status is that of schemathesis."""
    tester = shutil.which("schemathesis")
    if tester is None:
        raise SystemExit("schemathesis is not on PATH: pip install schemathesis")
    begun, seen = 0, list[dict[str, Any]]()
    with tempfile.TemporaryDirectory() as text, daemon_of(program, Path(text)) as daemon, daemon.client() as client:
        folder, address = Path(text), f"http://{daemon.settings.address}/openapi.json"
        header = f"Authorization: Bearer {daemon.tokens.operate}"
        options = ["--max-time", f"{seconds:g}", "--checks", CHECKS, "--continue-on-failure", "--header", header]
        with (folder / "found.txt").open("w") as found:
            command = [tester, "run", address, *options]
            trying = subprocess.Popen(command, cwd=folder, stdout=found, stderr=subprocess.STDOUT, preexec_fn=ordinary)
            while trying.poll() is None:
                begun += keep_going(client, program, begun)
                seen.append(client.snapshot())
                time.sleep(LOOK)
        print((folder / "found.txt").read_text())
        told = daemon.events()
        events = [entry["event"] for entry in told]
        rows = [row for path in (folder / "data" / "runs").iterdir() for row in _rows(path)]
    working = sum(each["state"]["name"] == "RUNNING" for each in seen)
    made, late = (seen[-1][key] - seen[0][key] for key in ("tick", "late_ticks"))
    print(f"{program}: {begun} runs begun, RUNNING at {working} of {len(seen)} looks, {events.count('stop')} STOPs")
    print(f"  {made} snapshots, {late} late; {events.count('fault')} faults, {events.count('refused')} refusals logged")
    if program == "vibractl":
        late = sum(int(row["late"]) for row in rows)
        discarded = [entry["reason"] for entry in told if entry["event"] == "discarded"]
        print(f"  {len(rows)} shots, {late} late callbacks, {len(discarded)} recordings discarded: {discarded}")
    else:
        gauges = [{gauge["name"]: gauge["value"] for gauge in each["gauges"]} for each in seen]
        behind = max((each["behind"] or 0.0 for each in gauges if "behind" in each), default=0.0)
        print(f"  the simulation was at most {behind:.2f} s behind the clock")
    return int(trying.returncode)


def _rows(path: Path) -> list[dict[str, str]]:
    return read_quality(path) if (path / "qc.csv").exists() else []


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], float(sys.argv[2]) if len(sys.argv) > 2 else SECONDS))
