"""A page of rubicon in a real browser, for tests and pictures of it. Without chromium or python3-selenium the program that
imports this ends with status 77."""
import os
import shutil
import sys
import time

from live import PATIENCE, Socket


def skip(why):
    print("skipped:", why)
    sys.exit(77)


try:
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.support.ui import Select
except ImportError:
    if sys.executable != "/usr/bin/python3" and os.access("/usr/bin/python3", os.X_OK):
        os.execv("/usr/bin/python3", ["/usr/bin/python3", *sys.argv])  # the system's may have it
    skip("there is no python3-selenium")

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
if not CHROMIUM or not DRIVER:
    skip("there is no chromium or no chromedriver")


class Failed(Exception):
    pass


def check(holds, what, *details):
    if not holds:
        raise Failed(" ".join([what, *map(str, details)]))


def until(what, question):
    """Asks until the answer is true. @returns the answer."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        answer = question()
        if answer:
            return answer
        time.sleep(0.05)
    raise Failed("not within %d s: %s" % (PATIENCE, what))


class Page:
    def __init__(self, width=1280, height=720, before=None):
        self.told = []
        options = Options()
        options.binary_location = CHROMIUM
        for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.browser = webdriver.Chrome(service=Service(DRIVER), options=options)
        self.browser.set_script_timeout(PATIENCE)
        self.browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                     {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500})
        if before:
            self.browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": before})

    def open(self, url):
        self.browser.get(url)
        self.server = Socket(url)
        until("a picture", lambda: self.js("return window.rubicon && rubicon.shown().first_picture_ms > 0"))

    def js(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def shown(self):
        return self.js("return rubicon.shown()")

    def find(self, name):
        return self.browser.find_element(By.ID, name)

    def tab(self, name):
        self.find("tab-" + name).click()
        until(name, lambda: self.shown()["tab"] == name)

    def show(self, t):
        self.js("const at = document.getElementById('at'); at.value = arguments[0]; at.dispatchEvent(new Event('change'))", "%.3f" % t)

    def errors(self):
        self.told += [x["message"] for x in self.browser.get_log("browser") if x["level"] == "SEVERE"]
        return self.told

    def click_map(self, name):
        self.js("""
            const place = rubicon.place(arguments[0]);
            for (const type of ['pointermove', 'pointerdown', 'pointerup'])
              document.getElementById('map').dispatchEvent(new PointerEvent(type, {clientX: place.x, clientY: place.y, pointerId: 1, bubbles: true}));
            """, name)

    def close(self):
        self.browser.quit()
