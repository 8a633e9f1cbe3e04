"""A daemon of a rig and its page in Chromium, for taking pictures of it."""

import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rigkit.service.access import TOKENS, read_tokens
from rigkit.service.client import Client, DaemonError
from tests.rigkit.service.page.browser import Browser, browser
from tests.rigkit.service.served import free_port
from tests.until import until

PICTURES = Path(__file__).parents[1] / "docs" / "images" / "service"
WALL = (1440, 1000)
SETTLED = 1000.0
"""ms for the page to take its new size."""
MINUTES = 1200.0
"""s to wait for what takes minutes."""


class Page:
    """The page of a daemon, in the hands of somebody who has control.

    Parameters
    ----------
    tab : Browser
    data : Path
        The daemon's folder.
    daemon : Popen
    """

    def __init__(self, tab: Browser, data: Path, daemon: subprocess.Popen[bytes]) -> None:
        self.tab, self.data, self._daemon = tab, data, daemon

    def arm(self, why: str) -> None:
        """Take control, as Ada, and arm."""
        self.tab.until_state("DISARMED")
        self.tab.type("who", "Ada")
        self.tab.press("take-button")
        until(lambda: self.tab.shows("why"))
        self.tab.type("why", why)
        self.tab.press("arm")
        until(lambda: self.tab.text("state-name") == "ARMED", MINUTES)

    def begin(self, procedure: str, **options: str) -> None:
        """Begin a procedure with the page's own form."""
        choose = "const which = document.getElementById('which'); which.value = arguments[0]; which.onchange()"
        self.tab.run(f"{choose}; document.querySelector('details').open = true", procedure)
        for name, value in options.items():
            if self.tab.find(f"option-{name}").tag_name == "select":
                self.tab.run("document.getElementById(arguments[0]).value = arguments[1]", f"option-{name}", value)
            else:
                self.tab.type(f"option-{name}", value)
        self.tab.press("begin-button")
        until(lambda: self.tab.text("state-name") in ("RUNNING", "CALIBRATING"))

    def ended(self) -> None:
        """Wait until the procedure has ended well.

        Raises
        ------
        RuntimeError : by a fault, with its reason.
        """
        until(lambda: self.tab.text("state-name") in ("ARMED", "FAULT"), MINUTES)
        if self.tab.text("state-name") == "FAULT":
            raise RuntimeError(self.tab.text("state-why"))

    def until_panel(self, title: str) -> None:
        """Wait until a panel's title has a text in it."""
        titles = "return [...document.querySelectorAll('.panel h2')].map(head => head.textContent).join('\\n')"
        until(lambda: title in str(self.tab.run(titles)), MINUTES)

    def until_some_is_done(self) -> None:
        """Wait until the page says how much time is left."""
        until(lambda: "left" in self.tab.text("summary"), MINUTES)

    def until_done(self, text: str) -> None:
        """Wait until progress begins with a text."""
        until(lambda: self.tab.text("procedure-done").startswith(text), MINUTES)

    def until_output(self, text: str) -> None:
        """Wait until the light of the output says a text."""
        until(lambda: self.tab.text("light-output") == text, MINUTES)

    def take(self, size: tuple[int, int], dark: bool = False) -> None:
        """Take a size, light or dark, and wait until the page stands in it."""
        self.tab.resize(size, dark)
        self.tab.run("scrollTo(0, 0)")
        begun = self.tab.run("return performance.now()")
        until(lambda: self.tab.run("return performance.now()") > begun + SETTLED)

    def picture(self, name: str, whole: bool = False) -> None:
        """Save what is seen, or the whole page, among the pictures."""
        self.tab.picture(PICTURES / f"{name}.png", whole)

    def kill(self) -> None:
        """Kill the daemon, and wait until the page says for how long it has been dead."""
        self._daemon.kill()
        until(lambda: self.tab.text("alarm-age") == "(2 s)")


@contextmanager
def page(program: str, settings: Sequence[str]) -> Iterator[Page]:
    """Start a program's daemon in a folder of its own, and open its page.

    Parameters
    ----------
    program : str
        "vibractl" or "stagectl".
    settings : sequence of str
        Laid over the defaults, "table.key=value".
    """
    PICTURES.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        address = f"127.0.0.1:{free_port()}"
        given = f"daemon.data={folder}", f"daemon.address={address}", *settings
        daemon = subprocess.Popen([sys.executable, "-m", program, "daemon", *(f"--set={each}" for each in given)])
        try:
            token = _token(Path(folder), address)
            with browser() as tab:
                tab.resize(WALL)
                tab.open(f"http://{address}", token)
                yield Page(tab, Path(folder), daemon)
        finally:
            daemon.kill()
            daemon.wait()


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
