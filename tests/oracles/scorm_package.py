#!/usr/bin/env python3
"""Drives a package of `exercise pack` in Chromium, with the SCORM 1.2 runtime of the npm package
scorm-again as the learning platform: launch, suspend, resume, score, complete.

    scorm_package.py GSK980TD PAGE SCORM-AGAIN PICTURES

PAGE is the folder that `cargo xtask dist web` builds, SCORM-AGAIN the folder of the npm package
(`npm install scorm-again`: node_modules/scorm-again). Needs chromium and chromium-driver.
"""

import functools
import http.server
import json
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
import xml.etree.ElementTree as xml
import zipfile
from base64 import b64decode
from pathlib import Path

TASKS = ["04-spindle", "05-tool-change"]
MASTERY = 60
SIZE = (1500, 950)
# The platform: the runtime, the stored values of the learner, and the package in a frame.
PLATFORM = """<!DOCTYPE html><meta charset="utf-8">
<style>html, body { margin: 0; height: 100%; } iframe { border: 0; width: 100%; height: 99%; }</style>
<script src="runtime.js"></script>
<script>
const Runtime = window.Scorm12API || window.ScormAgain?.Scorm12API;
window.API = new Runtime({ autocommit: false, logLevel: 4 });
const stored = JSON.parse(localStorage.getItem("platform") || "null");
window.API.loadFromJSON(stored || { core: { student_id: "7", student_name: "Li, Ming" } }, "cmi");
window.log = [];
for (const name of ["LMSInitialize", "LMSSetValue", "LMSCommit", "LMSFinish"]) {
  window.API.on(name, (...values) => window.log.push([name, ...values].join(" ")));
}
function keep() {
  const json = window.API.renderCommitCMI(true);
  localStorage.setItem("platform", JSON.stringify(json.cmi));
}
window.API.on("LMSCommit", keep);
window.API.on("LMSFinish", keep);
</script>
<iframe id="page" src="package/index.html?lang=en"></iframe>
"""


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class Driver:
    """Chromium through chromedriver."""

    def __init__(self):
        self.process = subprocess.Popen(
            ["chromedriver", "--port=9517"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        arguments = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader"]
        arguments += ["--enable-unsafe-swiftshader", f"--window-size={SIZE[0]},{SIZE[1]}"]
        options = {"args": arguments}
        capabilities = {"alwaysMatch": {"goog:chromeOptions": options}}
        self.base = "http://127.0.0.1:9517/session"
        for attempt in range(60):
            try:
                answer = self.post("", {"capabilities": capabilities})
                break
            except OSError:
                time.sleep(0.5)
        self.base += "/" + answer["sessionId"]

    def post(self, path, body=None, method="POST"):
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.base + path, data, method=method)
        with urllib.request.urlopen(request, timeout=300) as answer:
            return json.load(answer)["value"]

    def go(self, address):
        self.post("/url", {"url": address})

    def js(self, text):
        return self.post("/execute/sync", {"script": f"return {text}", "args": []})

    def picture(self, path):
        Path(path).write_bytes(b64decode(self.post("/screenshot", method="GET")))

    def click(self, x, y):
        pointer = {"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}}
        moves = {"type": "pointerMove", "x": x, "y": y}
        down, up = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
        pause = {"type": "pause", "duration": 120}
        pointer["actions"] = [moves, pause, down, pause, up]
        self.post("/actions", {"actions": [pointer]})
        time.sleep(0.6)

    def end(self):
        self.post("", method="DELETE")
        self.process.terminate()


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
