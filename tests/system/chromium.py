"""Headless Chromium for the tests of pages; pictures lie in build/view."""
import shutil
import tempfile

import pytest

from afo import BUILD
from viewer import PATIENCE_S, wait_until

selenium = pytest.importorskip("selenium.webdriver")
from selenium.webdriver.chrome.options import Options  # noqa: E402
from selenium.webdriver.chrome.service import Service  # noqa: E402
from selenium.webdriver.common.by import By  # noqa: E402, F401
from selenium.webdriver.common.keys import Keys  # noqa: E402

PICTURES = BUILD / "view"
QUIET = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--window-size=1280,1500")


@pytest.fixture(scope="module")
def browser():
    profile = tempfile.mkdtemp(prefix="chromium")
    options = Options()
    options.binary_location = shutil.which("chromium")
    for one in (*QUIET, f"--user-data-dir={profile}"):
        options.add_argument(one)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = selenium.Chrome(options=options, service=Service(shutil.which("chromedriver")))
    driver.set_script_timeout(PATIENCE_S)
    driver.set_page_load_timeout(PATIENCE_S)
    yield driver
    driver.quit()
    shutil.rmtree(profile, ignore_errors=True)


class Page:
    def __init__(self, browser, view):
        self.browser = browser
        browser.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        browser.get("about:blank")
        browser.get(view.url)
        wait_until(lambda: self.js("return Boolean(window.afo && afo.store && afo.store.next > 0)"), "rows on the page")

    def js(self, code, *arguments):
        return self.browser.execute_script(code, *arguments)

    def text(self, selector):
        return self.js("return document.querySelector(arguments[0])?.innerText ?? ''", selector)

    def keys(self, *keys):
        """To whatever has the focus, as a keyboard does."""
        self.browser.switch_to.active_element.send_keys(*keys)

    def focus(self, identifier):
        self.js("document.getElementById(arguments[0]).focus()", identifier)
        return self.browser.switch_to.active_element

    def tab_to(self, identifier, part):
        """By the page's own links to its parts, and Tab."""
        self.js("document.querySelector(`nav a[href='#${arguments[0]}']`).focus()", part)
        for keys in (Keys.ENTER + Keys.TAB, *(Keys.TAB for _ in range(100))):
            self.keys(keys)
            if self.js("return document.activeElement.id") == identifier:
                return self.browser.switch_to.active_element
        raise AssertionError(f"Tab never reaches {identifier}")

    def until(self, code, what):
        return wait_until(lambda: self.js(code), what)

    def until_text(self, selector, words):
        return wait_until(lambda: words in self.text(selector), f"{words!r} in {selector}: {self.text(selector)!r}")

    def figure(self):
        return self.js("return document.getElementById('figure').toDataURL()")

    def picture(self, name):
        PICTURES.mkdir(parents=True, exist_ok=True)
        assert self.browser.save_screenshot(str(PICTURES / f"{name}.png"))

    def complaints(self):
        return [line for line in self.browser.get_log("browser") if line["level"] == "SEVERE"]


def prefer(browser, scheme):
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
