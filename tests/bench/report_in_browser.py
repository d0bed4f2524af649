"""
Loads a report in headless Chromium at several widths and checks what a person would see: nothing
wider than the page, no request to anybody, and the answer and its chart on the first screen.

    report_in_browser.py WRITE_STUDY GAZEBENCH [SCENE [PICTURES]]

SCENE lies behind the maps; PICTURES is a folder for screenshots. Exits 77 without Chromium or
gnuplot.
"""
import base64
import html
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# Width and height of the window, and whether the page is dark. A phone's and a laptop's.
WINDOWS = [(1280, 900, False), (400, 860, False), (1280, 900, True), (400, 860, True)]

PROBE = """(() => {
	const root = document.documentElement;
	const bottom = selector => {
		const element = document.querySelector(selector);
		return element ? element.getBoundingClientRect().bottom : null;
	};
	const images = [...document.images];
	return {
		wide: root.scrollWidth,
		answer: bottom('.answer'),
		chart: bottom('figure.first img'),
		images: images.length,
		broken: images.filter(image => !(image.complete && image.naturalWidth > 0)).length,
		scripts: document.scripts.length,
		headings: document.querySelectorAll('h1').length,
		banners: document.querySelectorAll('.banner').length,
		sections: document.querySelectorAll('section').length,
		columns: new Set([...document.querySelectorAll('.maps figure')]
			.map(figure => figure.getBoundingClientRect())
			.filter(box => box.width > 0).map(box => box.left)).size,
		height: root.scrollHeight,
		text: document.body.innerText,
	};
})()"""


class Browser:
    """Chromium, spoken to through two pipes by its DevTools protocol: no port, no other library."""

    def __init__(self, program, folder):
        to_browser, self.out = os.pipe()
        self.inp, from_browser = os.pipe()

        def place():
            # Both may lie on 3 or 4: out of the way first.
            a, b = os.dup(to_browser), os.dup(from_browser)
            while min(a, b) < 5:
                a, b = os.dup(a), os.dup(b)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
             "--no-first-run", "--disable-extensions", "--disable-background-networking",
             "--remote-debugging-pipe", "--user-data-dir=" + folder, "about:blank"],
            preexec_fn=place, close_fds=False, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.bytes = b""
        self.number = 0
        self.session = None
        self.events = []
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target,
                                 flatten=True)["sessionId"]
        self.call("Page.enable")
        self.call("Network.enable")

    def receive(self):
        while b"\0" not in self.bytes:
            more = os.read(self.inp, 1 << 20)
            if not more:
                raise RuntimeError("Chromium ended")
            self.bytes += more
        message, self.bytes = self.bytes.split(b"\0", 1)
        return json.loads(message)

    def call(self, method, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def wait_for(self, method):
        while not any(event.get("method") == method for event in self.events):
            self.events.append(self.receive())

    def load(self, url, width, height, dark):
        """What the probe says of the page, and the addresses that it asked for."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=False)
        self.call("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self.events = []
        self.call("Page.navigate", url=url)
        self.wait_for("Page.loadEventFired")
        seen = self.call("Runtime.evaluate", expression=PROBE,
                         returnByValue=True)["result"]["value"]
        asked = [event["params"]["request"]["url"] for event in self.events
                 if event.get("method") == "Network.requestWillBeSent"]
        return seen, asked

    def screenshot(self, path, whole, width, height):
        clip = {"x": 0, "y": 0, "width": width, "height": height, "scale": 1}
        picture = self.call("Page.captureScreenshot", captureBeyondViewport=whole, clip=clip)
        pathlib.Path(path).write_bytes(base64.b64decode(picture["data"]))

    def close(self):
        self.process.terminate()
        self.process.wait()
        os.close(self.out)
        os.close(self.inp)


failures = []


def check(holds, what):
    if not holds:
        failures.append(what)
        print("FAILED:", what)


def check_page(name, url, width, height, seen, asked, has_charts, banners):
    where = f"{name} at {width} px"
    outside = [address for address in asked
               if address != url and not address.startswith("data:")]
    check(not outside, f"{where}: asks for {outside[:3]}")
    check(seen["wide"] <= width, f"{where}: is {seen['wide']} px wide")
    check(seen["answer"] is not None and seen["answer"] <= height,
          f"{where}: the answer ends at {seen['answer']} px of {height}")
    if has_charts:
        check(seen["chart"] is not None and seen["chart"] <= height,
              f"{where}: the chart ends at {seen['chart']} px of {height}")
        check(seen["images"] > 10, f"{where}: only {seen['images']} pictures")
        columns = 2 if width > 1000 else 1
        check(seen["columns"] == columns,
              f"{where}: maps stand in {seen['columns']} columns, not {columns}")
    else:
        check(seen["images"] == 0, f"{where}: {seen['images']} pictures without gnuplot")
    check(seen["broken"] == 0, f"{where}: {seen['broken']} pictures are broken")
    check(seen["scripts"] == 0, f"{where}: {seen['scripts']} scripts")
    check(seen["headings"] == 1, f"{where}: {seen['headings']} first headings")
    check(seen["banners"] == banners, f"{where}: {seen['banners']} banners, not {banners}")


def check_labels(name, page):
    """No level text that ends at an anchor begins left of its chart; digits are 0.55 em or more."""
    charts = re.findall(r"data:image/svg\+xml;base64,([A-Za-z0-9+/=]+)", page)
    labels = 0
    for chart in charts:
        text = base64.b64decode(chart).decode()
        check("…" not in text or "half of all frames" not in text,
              f"{name}: a name beside or above its box is cut short")
        for x, size, label in re.findall(
                r'translate\(([-0-9.]+),[-0-9.]+\)"[^>]*font-size="([0-9.]+)"[^>]*text-anchor="end">\s*'
                r"<text>([^<]*)</text>", text):
            labels += 1
            label = html.unescape(label)
            check(float(x) >= 0.55 * float(size) * len(label),
                  f"{name}: {label} ends {x} px from a chart's left, and is cut off")
    check(not charts or labels > 10, f"{name}: only {labels} labels in {len(charts)} charts")


def make_report(write_study, gazebench, folder, kind, scene, gnuplot):
    arguments = [write_study, folder, kind] + ([scene] if scene and kind == "one" else [])
    subprocess.run(arguments, check=True)
    environment = dict(os.environ)
    if not gnuplot:
        environment["PATH"] = "/nonexistent"
    return subprocess.run([gazebench, "report", folder], env=environment, text=True,
                          capture_output=True, check=True)


def main():
    write_study, gazebench = sys.argv[1:3]
    scene = sys.argv[3] if len(sys.argv) > 3 else None
    pictures = sys.argv[4] if len(sys.argv) > 4 else None
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if not program or not shutil.which("gnuplot"):
        print("skipped: no Chromium, or no gnuplot")
        return 77
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        browser = Browser(program, os.path.join(folder, "profile"))
        try:
            for name, kind, gnuplot, banners in [("one", "one", True, 0),
                                                 ("several", "several", True, 0),
                                                 ("partial", "partial", True, 1),
                                                 ("no gnuplot", "one", False, 1)]:
                study = os.path.join(folder, name)
                said = make_report(write_study, gazebench, study, kind, scene, gnuplot)
                check(gnuplot or "gnuplot is not installed" in said.stderr,
                      f"{name}: nothing said of gnuplot: {said.stderr}")
                check(not any(file.startswith("charts-") for file in os.listdir(study)),
                      f"{name}: a working folder is left")
                check_labels(name, pathlib.Path(study, "report.html").read_text())
                url = pathlib.Path(study, "report.html").as_uri()
                for width, height, dark in WINDOWS:
                    seen, asked = browser.load(url, width, height, dark)
                    check_page(name, url, width, height, seen, asked, gnuplot, banners)
                    if kind == "several":
                        check("a <b> & 'c' \"d\"" in seen["text"],
                              f"{name}: a scene's name is not shown as it is")
                        check(seen["sections"] == 2 * 2 + 2,
                              f"{name}: {seen['sections']} sections")
                    if pictures:
                        shade = "dark" if dark else "light"
                        path = os.path.join(pictures, f"{name}-{width}-{shade}")
                        browser.screenshot(path + "-first.png", False, width, height)
                        browser.screenshot(path + ".png", True, width, seen["height"])
        finally:
            browser.close()
    print(f"{len(failures)} failures")
    return 1 if failures else 0


sys.exit(main())
