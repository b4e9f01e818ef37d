#!/usr/bin/env python3
"""Drives a package of `exercise pack` in Chromium and Firefox, in both languages, with the SCORM 1.2
runtime of the npm package scorm-again as the learning platform: launch, suspend, resume, score,
complete.

    scorm_package.py GSK980TD PAGE SCORM-AGAIN PICTURES [chromium-en] [firefox-zh] ...

PAGE is the folder that `cargo xtask dist web` builds, SCORM-AGAIN the folder of the npm package
(`npm install scorm-again`: node_modules/scorm-again). Needs chromium, chromium-driver, firefox-esr,
python3-websockets and a display.
"""

import asyncio
import functools
import http.server
import json
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree as xml
import zipfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from browser import Browser, Quiet

TASKS = ["04-spindle", "05-tool-change"]
MASTERY = 60
SIZE = {"width": 1500, "height": 950}
RUNS = ["chromium-en", "chromium-zh", "firefox-en", "firefox-zh"]
# Positions in a page of this size, pixels.
POINTS = {
    **{"first card": (880, 634), "second card": (1126, 634)},
    **{"MDI": (530, 73), "PRG": (117, 839), "PGDN": (38, 622), "IN": (55, 750), "START": (676, 384)},
    **{"S": (227, 566), "T": (273, 566), "M": (318, 566)},
    **{"0": (417, 680), "3": (462, 622), "5": (417, 566), "6": (462, 566)},
}
# The buttons of an offered task, of a task, then those of a report, in each language.
POINTS_OF = {
    "en": {"begin": (785, 904), "save result": (1040, 724), "hand in": (792, 904), "again": (876, 904), "leave report": (992, 904)},
    "zh": {"begin": (780, 904), "save result": (1022, 724), "hand in": (782, 904), "again": (845, 904), "leave report": (927, 904)},
}
# The platform: the runtime, the stored values of the learner, and the package in a frame.
PLATFORM = """<!DOCTYPE html><meta charset="utf-8">
<style>html, body { margin: 0; height: 100%; } iframe { border: 0; width: 100%; height: 99%; }</style>
<script src="runtime.js"></script>
<script>
const Runtime = window.Scorm12API || window.ScormAgain?.Scorm12API;
window.API = new Runtime({ autocommit: false, logLevel: 4 });
const stored = localStorage.getItem("platform");
const learner = { "cmi.core.student_id": "7", "cmi.core.student_name": "Li, Ming" };
window.API.loadFromFlattenedJSON(stored ? JSON.parse(stored) : learner, "");
window.log = [];
for (const name of ["LMSInitialize", "LMSSetValue", "LMSCommit", "LMSFinish"]) {
  window.API.on(name, (...values) => window.log.push([name, ...values].join(" ")));
}
function flatten(value, path, into) {
  for (const [name, inner] of Object.entries(value)) {
    if (inner && typeof inner === "object") flatten(inner, `${path}${name}.`, into);
    else if (inner !== "") into[path + name] = String(inner);
  }
  return into;
}
function keep() {
  const json = JSON.parse(JSON.stringify(window.API.renderCommitCMI(true)));
  localStorage.setItem("platform", JSON.stringify(flatten(json, "", {})));
}
window.API.on("LMSCommit", keep);
window.API.on("LMSFinish", keep);
</script>
<iframe id="page"></iframe>
<script>
document.getElementById("page").src = `package/index.html?lang=${location.search.slice(1)}`;
</script>
"""


class Driver:
    """A browser, driven from code that is not asynchronous."""

    def __init__(self, name, downloads):
        self.loop = asyncio.new_event_loop()
        threading.Thread(target=self.loop.run_forever, daemon=True).start()
        self.browser = Browser(name, SIZE, downloads)
        self.run(self.browser.start())

    def run(self, work):
        return asyncio.run_coroutine_threadsafe(work, self.loop).result()

    def go(self, address):
        self.run(self.browser.go(address))

    def js(self, text):
        answer = self.run(self.browser.js(f"JSON.stringify({text}) ?? 'null'"))
        return json.loads(answer)

    def picture(self, path):
        self.run(self.browser.picture(path))

    def click(self, x, y):
        self.run(self.browser.press((x, y)))

    def end(self):
        self.run(self.browser.end())
        self.loop.call_soon_threadsafe(self.loop.stop)


def check_package(package):
    """The archive as another reader sees it, and the manifest."""
    with zipfile.ZipFile(package) as archive:
        assert archive.testzip() is None
        names = archive.namelist()
        manifest = xml.fromstring(archive.read("imsmanifest.xml"))
        files = [it.attrib["href"] for it in manifest.iter() if it.tag.endswith("}file")]
        assert sorted(files + ["imsmanifest.xml"]) == sorted(names), (files, names)
        resource = next(it for it in manifest.iter() if it.tag.endswith("}resource"))
        assert resource.attrib["href"] in names
        assert resource.attrib["{http://www.adlnet.org/xsd/adlcp_rootv1p2}scormtype"] == "sco"
    return names


def main():
    program, page, runtime, pictures = (Path(word).resolve() for word in sys.argv[1:5])
    pictures.mkdir(parents=True, exist_ok=True)
    served = Path(tempfile.mkdtemp(prefix="scorm-"))
    package = served / "package.zip"
    command = [program, "exercise", "pack", *TASKS, "--page", page, "-o", package]
    subprocess.run([*command, "--mastery", str(MASTERY), "--title", "Turning"], check=True)
    names = check_package(package)
    print(f"the package: {package.stat().st_size // 1000} kB, {len(names)} files, as the manifest lists")
    with zipfile.ZipFile(package) as archive:
        archive.extractall(served / "package")
    (served / "runtime.js").write_bytes((runtime / "dist/scorm12.js").read_bytes())
    (served / "platform.html").write_text(PLATFORM)
    handler = functools.partial(Quiet, directory=str(served))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}/platform.html"
    for run in sys.argv[5:] or RUNS:
        name, language = run.split("-")
        print(f"{run}:")
        downloads = served / run
        downloads.mkdir()
        driver = Driver(name, downloads)
        try:
            learn(Learner(driver, f"{address}?{language}", pictures, language))
            result = wait_for("the downloaded result", lambda: next(downloads.glob("*.gskresult"), None))
            subprocess.run([program, "exercise", "mark", downloads, "--lang", "en"], check=True)
            print(f"{result.name} is replayed as the browser marked it")
        finally:
            driver.end()


def wait_for(what, find, seconds=60):
    for _ in range(seconds * 4):
        found = find()
        if found:
            return found
        time.sleep(0.25)
    raise SystemExit(f"{what} does not come")


class Learner:
    """A learner at the page in the platform's frame."""

    def __init__(self, driver, address, pictures, language):
        self.driver, self.address, self.pictures = driver, address, pictures
        self.points = POINTS | POINTS_OF[language]
        self.run = f"{driver.browser.name}-{language}"

    def launch(self):
        self.driver.go(self.address)
        wait_for("the control", lambda: "现在位置" in self.lcd(), 120)
        time.sleep(3)

    def leave(self):
        self.driver.js("(document.getElementById('page').src = 'about:blank', true)")
        time.sleep(1)
        return self.driver.js("window.log")

    def lcd(self):
        text = "document.getElementById('page').contentDocument.getElementById('lcd')?.textContent"
        return self.driver.js(text) or ""

    def value(self, name):
        return self.driver.js(f"window.API.cmi.{name}")

    def attempts(self):
        return self.driver.js("window.API.cmi.interactions.childArray.length")

    def picture(self, name):
        self.driver.picture(self.pictures / f"{self.run}-{name}.png")

    def click(self, *names):
        for name in names:
            self.driver.click(*self.points[name])

    def hand_in(self):
        before = self.attempts()
        self.click("hand in")
        wait_for("the marks", lambda: self.attempts() == before + 1)

    def expect(self, what, **values):
        found = {name: self.value(name.replace("__", ".")) for name in values}
        if found != values:
            self.picture("failed")
            raise SystemExit(f"{what}: {found} instead of {values}")
        print(f"{what}: {' '.join(str(value) for value in values.values())}")


def learn(learner):
    learner.launch()
    learner.picture("launch")
    learner.expect("launched", core__lesson_status="incomplete", suspend_data="")
    learner.click("first card", "begin")
    learner.click("MDI", "PRG", "PGDN", "S", "6", "0", "0", "IN", "M", "3", "IN", "START")
    time.sleep(4)
    learner.click("M", "5", "IN", "START")
    time.sleep(4)
    learner.picture("solved")
    learner.hand_in()
    time.sleep(1)
    learner.picture("marked")
    learner.expect("first exercise", core__score__raw="50", core__lesson_status="incomplete")
    learner.click("save result")
    # An exercise that is not handed in, then the end of the session.
    learner.click("leave report", "second card", "begin")
    log = learner.leave()
    if not any(line.startswith("LMSFinish") for line in log):
        raise SystemExit(f"the session was not finished: {log}")
    learner.launch()
    learner.picture("resumed")
    learner.expect("resumed", core__score__raw="50", core__lesson_status="incomplete")
    learner.click("second card", "begin")
    learner.hand_in()
    learner.expect("nothing done", core__score__raw="50", core__lesson_status="failed")
    learner.click("again", "MDI", "PRG", "PGDN", "T", "0", "3", "0", "3", "IN", "START")
    time.sleep(8)
    learner.picture("second")
    learner.hand_in()
    learner.expect("better attempt", core__lesson_status="passed")
    score = float(learner.value("core.score.raw"))
    data = learner.value("suspend_data")
    if not MASTERY <= score < 100 or len(data) > 4096 or learner.attempts() != 3:
        raise SystemExit(f"score {score}, {learner.attempts()} attempts, progress {data}")
    learner.leave()
    time_text = learner.driver.js("JSON.parse(localStorage.getItem('platform'))['cmi.core.total_time']")
    print(f"passed with {score} %, progress {len(data)} characters, time {time_text}")


main()
