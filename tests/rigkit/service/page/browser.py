"""Chromium without a screen, for looking at the daemon's page as a person would."""

import base64
import json
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from selenium.webdriver import ActionChains, Chrome, ChromeOptions
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

from tests.until import until

DESKTOP, PHONE = (1440, 900), (390, 844)
_FLAGS = (
    "headless no-sandbox disable-gpu disable-quic no-first-run disable-background-networking disable-component-update "
    "disable-sync disable-dev-shm-usage hide-scrollbars force-color-profile=srgb"
)


def hindrance() -> str:
    """Say why there is no browser to look with; empty where there is one."""
    missing = [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    return f"not installed: {', '.join(missing)} (apt-get install chromium-driver)" if missing else ""


class Browser:
    """A tab of Chromium.

    Parameters
    ----------
    driver : Chrome
    """

    def __init__(self, driver: Chrome) -> None:
        self.driver = driver

    def resize(self, size: tuple[int, int], dark: bool = False) -> None:
        """Take a size in CSS pixels, that of a phone with its touch; and light or dark."""
        is_phone = size[0] < 600
        metrics = {"width": size[0], "height": size[1], "deviceScaleFactor": 2 if is_phone else 1, "mobile": is_phone}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})

    def open(self, address: str, token: str = "") -> None:
        """Open the page of a daemon in a tab that knows of nothing; with a token, as with one in the address."""
        self.driver.get("about:blank")
        forget = {"source": "sessionStorage.clear(); localStorage.clear()"}  # before any script of the page
        made = self.driver.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", forget)
        self.driver.get(f"{address}/#token={token}" if token else f"{address}/")
        self.driver.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", made)

    def find(self, name: str) -> WebElement:
        """Return the element of that id."""
        return self.driver.find_element(By.ID, name)

    def text(self, name: str) -> str:
        """Return what an element says, seen or not."""
        return str(self.run("return document.getElementById(arguments[0]).textContent", name))

    def run(self, script: str, *arguments: Any) -> Any:
        """Run a script in the page."""
        return self.driver.execute_script(script, *arguments)

    def shows(self, name: str) -> bool:
        """Whether an element is to be seen."""
        return self.find(name).is_displayed()

    def key(self, key: str) -> None:
        """Press a key where the focus is."""
        ActionChains(self.driver).send_keys(key).perform()

    def hold_down(self, name: str) -> None:
        """Press the mouse on an element, and keep it down."""
        ActionChains(self.driver).click_and_hold(self.find(name)).perform()

    def let_go(self) -> None:
        """Let the mouse go."""
        ActionChains(self.driver).release().perform()

    def press(self, name: str) -> None:
        """Wait until a button can be pressed, and press it with Enter."""
        until(lambda: self.find(name).is_displayed() and self.find(name).is_enabled())
        self.find(name).send_keys(Keys.ENTER)

    def type(self, name: str, text: str) -> None:
        """Type text into a field, in the place of what it holds."""
        self.find(name).clear()
        self.find(name).send_keys(text)

    def until_state(self, *states: str) -> None:
        """Wait until the page shows one of these states."""
        until(lambda: self.text("state-name") in states)

    def requested(self) -> set[str]:
        """Return the addresses that were asked for since this was called last; the browser's own pages left out."""
        entries = [json.loads(entry["message"])["message"] for entry in self.driver.get_log("performance")]
        sent = [entry["params"] for entry in entries if entry["method"] == "Network.requestWillBeSent"]
        sockets = [entry["params"] for entry in entries if entry["method"] == "Network.webSocketCreated"]
        found = {each["request"]["url"] for each in sent} | {each["url"] for each in sockets}
        return {url for url in found if not url.startswith(("chrome:", "chrome-untrusted:", "about:", "data:"))}

    def complaints(self) -> list[str]:
        """Return what the browser has complained of in its console: errors, refusals of the content policy."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]

    def save_into(self, folder: Path) -> None:
        """Let what the page has to be saved go into a folder, without asking."""
        self.driver.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(folder)})

    def picture(self, path: Path, whole: bool = False) -> None:
        """Save what is seen, or the whole page, as PNG."""
        options = {"format": "png", "captureBeyondViewport": whole}
        if whole:
            size = self.run("return [document.documentElement.clientWidth, document.documentElement.scrollHeight]")
            options["clip"] = {"x": 0, "y": 0, "width": size[0], "height": size[1], "scale": 1}
        shot = self.driver.execute_cdp_cmd("Page.captureScreenshot", options)
        path.write_bytes(base64.b64decode(shot["data"]))


@contextmanager
def browser() -> Iterator[Browser]:
    """Start Chromium, with a profile of its own, for the length of the block."""
    options = ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
    with tempfile.TemporaryDirectory(prefix="chromium-", ignore_cleanup_errors=True) as profile:
        for flag in (*_FLAGS.split(), f"user-data-dir={profile}"):
            options.add_argument(f"--{flag}")
        driver = Chrome(options, Service(shutil.which("chromedriver")))
        try:
            yield Browser(driver)
        finally:
            driver.quit()
