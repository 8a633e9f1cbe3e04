"""A JACK audio server without hardware under a private name, and the simulated vibrator as its client."""

import fcntl
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from ctypes.util import find_library
from typing import IO, Any

_NAMES = 4
_LONGEST_END = 10.0
"""s for a process to end when asked, before it is killed."""


def missing() -> str:
    """Return why no server can be started here; nothing when it can."""
    if not (shutil.which("jackd") and shutil.which("jack_wait")):
        return "jackd is not installed (apt-get install jackd2)"
    if not find_library("portaudio"):
        return "libportaudio is not installed (apt-get install libportaudio2)"
    return ""


@contextmanager
def jack_server(
    options: Sequence[str], rate: int, period: int, log: IO[str] | None = None
) -> Iterator[subprocess.Popen[bytes]]:
    """Run jackd with the dummy driver; programs started meanwhile find it through the environment.

    Parameters
    ----------
    options : sequence of str
        For jackd: "-r", "-S" is sample-exact without privilege; "-R", "-P70", "-S" is real time.
    rate : int, samples/s
    period : int, samples
    log : file, optional
        For what it says.
    """
    small = ("--port-max", "128", "-t", "5000")  # the default needs 100 MB of /dev/shm, more than containers have
    dummy = ("-d", "dummy", "-r", str(rate), "-p", str(period), "-C", "2", "-P", "2")
    with ExitStack() as held, _private_name() as name, _environment(name):
        log = held.enter_context(tempfile.TemporaryFile("w+")) if log is None else log
        command = ["jackd", "-n", name, *small, *options, *dummy]
        with _running(subprocess.Popen(command, stdout=log, stderr=log)) as server:
            if subprocess.run(["jack_wait", "-s", name, "-w", "-t", "10"], capture_output=True).returncode:
                log.seek(0)
                raise RuntimeError(f"jackd has not started: {log.read()[-500:]}")
            yield server


@contextmanager
def _environment(name: str) -> Iterator[None]:
    """Let the programs that are started meanwhile find this server, and start no other."""
    settings = {"JACK_DEFAULT_SERVER": name, "JACK_NO_START_SERVER": "1", "JACK_NO_AUDIO_RESERVATION": "1"}
    before = {key: os.environ.get(key) for key in settings}
    os.environ |= settings
    try:
        yield
    finally:
        for key, value in before.items():
            os.environ.pop(key) if value is None else os.environ.__setitem__(key, value)


@contextmanager
def _private_name() -> Iterator[str]:
    """Hold one of a few names for a server.

    A jackd that dies leaves its place in the machine's list of eight servers taken; only one of the same name takes it
    over.  With names that are never the same again no server would start after the eighth such death.
    """
    for number in range(_NAMES):
        path = os.path.join(tempfile.gettempdir(), f"vibrostage-jack-{os.getuid()}-{number}.lock")
        with open(path, "w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield f"vibrostage{number}"
            return
    raise RuntimeError(f"{_NAMES} JACK servers of ours run already")


@contextmanager
def vibrator_client(settings: Sequence[str]) -> Iterator[subprocess.Popen[str]]:
    """Run `firmware-sim vibrator --jack` as the client "shaker", from when it is ready.

    Parameters
    ----------
    settings : sequence of str
        "table.key=value" for `--set`.
    """
    command = [sys.executable, "-m", "firmware_sim", "vibrator", "--jack"]
    for setting in settings:
        command += ["--set", setting]
    client = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    with _running(client):
        assert client.stdout is not None
        if not client.stdout.readline().startswith("shaker is ready"):
            raise RuntimeError(client.communicate()[1])
        yield client


@contextmanager
def _running(process: "subprocess.Popen[Any]") -> Iterator["subprocess.Popen[Any]"]:
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.communicate(timeout=_LONGEST_END)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
