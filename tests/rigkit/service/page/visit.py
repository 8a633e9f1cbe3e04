"""A person at the page of a demonstration."""

from dataclasses import dataclass

from rigkit.service.client import DaemonError
from tests.rigkit.service.page.browser import Browser
from tests.rigkit.service.served import Served
from tests.until import until


@dataclass
class Visit:
    """A tab with the page, and the daemon behind it."""

    tab: Browser
    daemon: Served

    @property
    def address(self) -> str:
        return f"http://{self.daemon.settings.address}"

    def open(self, token: str = "") -> None:
        """Open the page."""
        self.tab.open(self.address, token)

    def take_control(self) -> None:
        """Take control as Ada, with the page's own form."""
        until(lambda: self.tab.shows("who"))
        self.tab.type("who", "Ada")
        self.tab.press("take-button")
        until(lambda: self.tab.shows("reasoned"))

    def begin(self, steps: int = 100_000) -> None:
        """Arm and begin a demonstration, with the page's own forms; whoever does has control."""
        self.tab.type("why", "to see it")
        self.tab.press("arm")
        self.tab.until_state("ARMED")
        self.tab.run("document.querySelector('details').open = true")
        self.tab.type("option-steps", str(steps))
        self.tab.press("begin-button")
        self.tab.until_state("RUNNING")

    def state(self) -> str:
        """Return the state, as the daemon has it."""
        with self.daemon.client() as client:
            return str(client.snapshot()["state"]["name"])

    def quiet(self) -> None:
        """Bring the rig to rest, with control free."""
        with self.daemon.client() as client:
            client.stop("test", "between two tests")
            until(lambda: client.snapshot()["procedure"] is None)
            with client.control("test", over=True):
                try:
                    client.command("acknowledge", "between two tests")
                except DaemonError:
                    pass  # there was no fault
