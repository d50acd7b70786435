# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless browser, by the WebDriver protocol of chromedriver."""
import base64
import json
import shutil
import subprocess
import time
import urllib.error
import urllib.request


def is_installed():
    return shutil.which("chromedriver") is not None


class Browser:
    """Chromium without a window, whose pages have this size [pixels]. A context manager. RuntimeError with its message."""

    def __init__(self, width=1280, height=800):
        self.driver = subprocess.Popen(["chromedriver", "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        for line in self.driver.stdout:
            if "successfully on port " in line:
                self.url = "http://127.0.0.1:" + line.rsplit(" ", 1)[1].strip().rstrip(".")
                break
        options = {"args": ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", f"--window-size={width},{height}",
                            "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--allow-file-access-from-files"]}
        try:
            answer = self.call("POST", "/session", {"capabilities": {"alwaysMatch": {
                "browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}}})
        except BaseException:
            self.driver.kill()
            raise
        self.url += "/session/" + answer["sessionId"]
        self.call("POST", "/timeouts", {"script": None, "pageLoad": 24 * 3600 * 1000})  # a large page takes long on a busy machine
        self.call("POST", "/goog/cdp/execute", {"cmd": "Emulation.setDeviceMetricsOverride", "params": {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}})

    def call(self, method, path, data=None):
        body = None if data is None else json.dumps(data).encode()
        request = urllib.request.Request(self.url + path, body, {"Content-Type": "application/json"}, method=method)
        try:
            with urllib.request.urlopen(request) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise RuntimeError(json.load(error)["value"]["message"]) from None

    def open(self, url):
        self.call("POST", "/url", {"url": url})

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def show_time(self, t):
        """Sets the time of a page of hilda view and waits until it is drawn."""
        script = "viewer.set_time(arguments[0]); const done = arguments[1]; requestAnimationFrame(() => requestAnimationFrame(() => done()))"
        self.call("POST", "/execute/async", {"script": script, "args": [t]})

    def wait(self, condition, seconds=20):
        """Waits until the expression is true, at most this time. Returns the time [s]."""
        start = time.monotonic()
        while not self.run("return " + condition):
            if time.monotonic() - start > seconds:
                raise TimeoutError(condition)
            time.sleep(0.05)
        return time.monotonic() - start

    def screenshot(self):
        return base64.b64decode(self.call("GET", "/screenshot"))

    def messages(self):
        """What the page has written to the console"""
        return [entry["message"] for entry in self.call("POST", "/se/log", {"type": "browser"})]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("DELETE", "")
        finally:
            self.driver.terminate()
            self.driver.stdout.close()
            self.driver.wait()
