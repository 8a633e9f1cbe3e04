"""Take the pictures of the daemon's page, of a run on the simulated vibrator: `python -m benchmarks.daemon_pictures`.

They go into docs/images/service/; it wants Chromium and takes some three minutes.
"""

import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from rigkit.service.access import TOKENS, read_tokens
from rigkit.service.client import Client, DaemonError
from tests.rigkit.service.page.browser import PHONE, Browser, browser
from tests.rigkit.service.served import free_port
from tests.rigkit.service.until import until

PICTURES = Path(__file__).parents[1] / "docs" / "images" / "service"
WALL = (1440, 1000)
SETTLED = 1000.0
"""ms for the page to take its new size."""
MINUTES = 600.0
"""s to wait for what takes minutes."""
SHOT = 4
"""The shot after which they are taken."""
OPTIONS = {"run": "40-90-hz", "shots": "30"}


def main() -> None:
    """Calibrate, learn, look, stop."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        address = f"127.0.0.1:{free_port()}"
        settings = f"daemon.data={folder}", f"daemon.address={address}", "rig.name=basin"
        command = [sys.executable, "-m", "vibractl", "daemon", *(f"--set={each}" for each in settings)]
        daemon = subprocess.Popen(command)
        try:
            token = _token(Path(folder), address)
            with browser() as tab:
                tab.resize(WALL)
                tab.open(f"http://{address}", token)
                _visit(tab, daemon)
        finally:
            daemon.kill()
            daemon.wait()


def _visit(tab: Browser, daemon: subprocess.Popen[bytes]) -> None:
    tab.until_state("DISARMED")
    tab.type("who", "Ada")
    tab.press("take-button")
    until(lambda: tab.shows("why"))
    tab.type("why", "basin is clear")
    tab.press("arm")
    tab.until_state("ARMED")
    _begin(tab, "calibrate", {})
    tab.until_state("CALIBRATING")
    until(lambda: tab.text("state-name") == "ARMED", MINUTES)
    _begin(tab, "run", OPTIONS)
    until(lambda: tab.text("procedure-done").startswith(f"{SHOT} of"), MINUTES)
    _picture(tab, "wall-dark", WALL, dark=True)
    _picture(tab, "wall", WALL)
    _picture(tab, "whole", WALL, whole=True)
    _picture(tab, "phone", PHONE)
    tab.run("document.getElementById('panels').scrollIntoView()")
    tab.picture(PICTURES / "phone-panels.png")
    _picture(tab, "old", WALL, killing=daemon)


def _begin(tab: Browser, procedure: str, options: dict[str, str]) -> None:
    choose = "const which = document.getElementById('which'); which.value = arguments[0]; which.onchange()"
    tab.run(f"{choose}; document.querySelector('details').open = true", procedure)
    for name, value in options.items():
        tab.type(f"option-{name}", value)
    tab.press("begin-button")


def _picture(
    tab: Browser,
    name: str,
    size: tuple[int, int],
    dark: bool = False,
    whole: bool = False,
    killing: subprocess.Popen[bytes] | None = None,
) -> None:
    """Take a picture in the middle of a shot, or of what the page shows after the daemon is killed there."""
    tab.resize(size, dark)
    tab.run("scrollTo(0, 0)")
    begun = tab.run("return performance.now()")
    until(lambda: tab.run("return performance.now()") > begun + SETTLED)
    for level in ("Output zero", "Output on"):
        until(partial(_lit, tab, level), MINUTES)
    if killing is not None:
        killing.kill()
        until(lambda: tab.text("alarm-age") == "(2 s)")
    tab.picture(PICTURES / f"{name}.png", whole)


def _lit(tab: Browser, level: str) -> bool:
    return tab.text("light-output") == level


def _token(folder: Path, address: str) -> str:
    """Return the token to operate, when the daemon answers."""

    def there() -> bool:
        if not (folder / TOKENS).exists():
            return False
        try:
            with Client(address, read_tokens(folder / TOKENS).operate) as client:
                return client.snapshot() is not None
        except DaemonError:
            return False

    until(there, MINUTES)
    return read_tokens(folder / TOKENS).operate


if __name__ == "__main__":
    main()
