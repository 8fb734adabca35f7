"""Debian's Chromium without a display, for videos, pictures and tests of the page."""

import contextlib
import importlib.util
import shutil
import tempfile

__all__ = ["BrowserError", "missing", "opened_page", "show", "started"]

CHROMIUM, DRIVER = "/usr/bin/chromium", "/usr/bin/chromedriver"
OPTIONS = (
    "--headless=new --no-sandbox --disable-gpu --disable-quic --no-first-run --hide-scrollbars"
    " --disable-background-networking --disable-component-update --disable-sync --disable-dev-shm-usage"
    " --enable-unsafe-swiftshader --force-device-scale-factor=1"
).split()
LOAD_S = 40.0


class BrowserError(Exception):
    """The reason why a browser or its page is not available."""


def missing():
    """Packages that must be installed for a browser, as text; "" if nothing is missing."""
    wanted = []
    if not shutil.which(CHROMIUM):
        wanted.append("chromium")
    if not shutil.which(DRIVER):
        wanted.append("chromium-driver")
    if importlib.util.find_spec("selenium") is None:
        wanted.append("python3-selenium")
    return f"install {', '.join(wanted)}" if wanted else ""


@contextlib.contextmanager
def started(log_requests=False):
    """A selenium driver, which is closed at the end. log_requests: its log `performance` has all requests."""
    lack = missing()
    if lack:
        raise BrowserError(f"a browser is needed: {lack}")
    from selenium import webdriver
    from selenium.common.exceptions import WebDriverException
    from selenium.webdriver.chrome.service import Service

    with tempfile.TemporaryDirectory(prefix="stg_browser_", ignore_cleanup_errors=True) as profile:
        options = webdriver.ChromeOptions()
        options.binary_location = CHROMIUM
        for option in (*OPTIONS, f"--user-data-dir={profile}"):
            options.add_argument(option)
        wanted = {"browser": "ALL", **({"performance": "ALL"} if log_requests else {})}
        options.set_capability("goog:loggingPrefs", wanted)
        try:
            driver = webdriver.Chrome(service=Service(DRIVER), options=options)
        except WebDriverException as error:
            raise BrowserError(f"chromium does not start: {error.msg.splitlines()[0]}") from None
        try:
            yield driver
        except WebDriverException as error:
            raise BrowserError(f"chromium fails: {(error.msg or 'too slow').splitlines()[0]}") from None
        finally:
            driver.quit()


def show(driver, url, width=1280, height=720):
    """Loads one of our pages and waits until it is drawn. Raises BrowserError if it is never drawn."""
    from selenium.common.exceptions import WebDriverException
    from selenium.webdriver.support.ui import WebDriverWait

    try:
        # The size of the window includes its frame.
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        driver.get("about:blank")  # another fragment of the same page would not be loaded again
        for name in driver.log_types:
            driver.get_log(name)
        driver.get(url)
        ready = "return document.documentElement.dataset.ready === 'yes'"
        WebDriverWait(driver, LOAD_S, 0.05).until(lambda d: d.execute_script(ready))
    except WebDriverException as error:
        raise BrowserError(f"the page does not open: {(error.msg or 'too slow').splitlines()[0]}") from None


@contextlib.contextmanager
def opened_page(url, width=1280, height=720):
    """A driver with one of our pages, loaded and drawn."""
    with started() as driver:
        show(driver, url, width, height)
        yield driver
