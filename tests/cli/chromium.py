# SPDX-License-Identifier: GPL-3.0-or-later
"""A Chromium without a screen, driven over its DevTools protocol through two pipes: nothing but the standard library is needed."""
import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import time


def program():
    """A Chromium that runs without a screen, or nothing (a package may be a mere stub that asks for another kind of package)."""
    for name in ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome"):
        path = shutil.which(name)
        if path and subprocess.run([path, "--version"], capture_output=True, timeout=60).returncode == 0:
            return path
    return None


class Page:
    """One page. `console`: what it wrote there and what it threw; `requests`: every address that it asked for."""

    def __init__(self, folder, width=1280, height=800, options=()):
        to_browser, self._out = os.pipe()
        self._in, from_browser = os.pipe()
        # Above 9, so that neither is 3 or 4 itself.
        ends = [fcntl.fcntl(fd, fcntl.F_DUPFD, 10) for fd in (to_browser, from_browser)]

        def place():
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self._process = subprocess.Popen(
            [program(), "--headless", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", "--remote-debugging-pipe", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", f"--user-data-dir={folder}/profile", f"--window-size={width},{height}", *options],
            preexec_fn=place, pass_fds=(3, 4, *ends), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={**os.environ, "HOME": str(folder)})
        for fd in (to_browser, from_browser, *ends):
            os.close(fd)
        self._rest, self._number, self._answers = b"", 0, {}
        self.console, self.requests, self.loaded = [], [], False
        self._session = None
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Runtime", "Page", "Network", "Log"):
            self.call(domain + ".enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self._session = None
            self.call("Browser.close", seconds=20)
            self._process.wait(20)
        except (AssertionError, OSError, subprocess.TimeoutExpired):
            self._process.kill()
            self._process.wait(20)
        os.close(self._in)
        os.close(self._out)

    def _read(self, seconds):
        ready, _, _ = select.select([self._in], [], [], max(0, seconds))
        if not ready:
            return
        data = os.read(self._in, 1 << 20)
        if not data:
            raise AssertionError("the browser has ended")
        *messages, self._rest = (self._rest + data).split(b"\0")
        for message in map(json.loads, messages):
            if "id" in message:
                self._answers[message["id"]] = message
            else:
                self._event(message["method"], message["params"])

    def _event(self, method, p):
        if method == "Runtime.consoleAPICalled" and p["type"] in ("error", "warning", "assert"):
            self.console.append(" ".join(str(a.get("value", a.get("description", ""))) for a in p["args"]))
        elif method == "Runtime.exceptionThrown":
            d = p["exceptionDetails"]
            self.console.append(d.get("exception", {}).get("description", d["text"]))
        elif method == "Log.entryAdded" and p["entry"]["level"] in ("error", "warning"):
            if "GPU stall due to ReadPixels" not in p["entry"]["text"]:  # of the tests' own looking at the picture
                self.console.append(p["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(p["request"]["url"])
        elif method == "Page.loadEventFired":
            self.loaded = True

    def call(self, method, seconds=120, **parameters):
        self._number += 1
        number = self._number
        message = {"id": number, "method": method, "params": parameters, **({"sessionId": self._session} if self._session else {})}
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self._out, data):]
        end = time.monotonic() + seconds
        while number not in self._answers:
            if time.monotonic() > end:
                raise AssertionError(f"no answer to {method} within {seconds} s; console: {self.console}")
            self._read(end - time.monotonic())
        answer = self._answers.pop(number)
        if "error" in answer:
            raise AssertionError(f"{method}: {answer['error']}")
        return answer["result"]

    def open(self, address, seconds=120):
        """Goes there and waits until the page says that it is ready or has failed."""
        self.loaded = False
        self.call("Page.navigate", url=address)
        return self.wait("(s => ['ready', 'failed'].includes(s) && s)(document.documentElement?.dataset.state)", seconds)

    def wait(self, expression, seconds=60):
        """Until the expression is true; its value."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.value(expression)
            if value:
                return value
            self._read(0.05)
        raise AssertionError(f"not within {seconds} s: {expression}; console: {self.console}")

    def value(self, expression, seconds=300):
        """Of an expression in the page, or of what it promises."""
        answer = self.call("Runtime.evaluate", seconds=seconds, expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise AssertionError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def click(self, x, y):
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="none" if kind == "mouseMoved" else "left", clickCount=1,
                      buttons=1 if kind == "mousePressed" else 0)

    def drag(self, x0, y0, x1, y1, steps=12):
        self.call("Input.dispatchMouseEvent", type="mousePressed", x=x0, y=y0, button="left", buttons=1, clickCount=1)
        for k in range(1, steps + 1):
            self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x0 + (x1 - x0) * k / steps, y=y0 + (y1 - y0) * k / steps, button="left", buttons=1)
        self.call("Input.dispatchMouseEvent", type="mouseReleased", x=x1, y=y1, button="left", clickCount=1)

    def screenshot(self, file):
        with open(file, "wb") as f:
            f.write(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))
