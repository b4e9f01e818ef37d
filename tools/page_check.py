#!/usr/bin/env python3
"""Opens the page in real browsers and uses it: mouse, finger, keys, files, a second tab.

    tools/page_check.py PAGE CHECK LINUX_PROGRAM GOLDEN_PROGRAM [chromium] [firefox]

PAGE is the folder that `cargo xtask dist web` builds, CHECK the folder with the session
in which every tick is hashed. The two programs print the expected results on this system.
In each browser the solutions of all exercises get the same marks, and their recordings replay
to the same states. The script saves pictures of the page in CHECK.
"""

import asyncio
import functools
import http.server
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import marks_check
from browser import Browser, Quiet

ROOT = Path(__file__).resolve().parent.parent
# Positions of controls on a page of the size of `browser.py` in English, pixels.
SAMPLES, FIRST_SAMPLE = (232, 14), (280, 44)
SPEED, FASTEST = (1013, 14), (1044, 284)
OPEN = (66, 14)
AUTO, START, POSITION, PROGRAM = (430, 75), (582, 331), (45, 719), (108, 719)
PAGE_DOWN = "\ue00f"
# The native program runs the same sample with the same keys, until the spindle stands still.
SCRIPT = "load 01-stepped-shaft.CNC\npress AUTO\npress CS\nwait idle 600s\nwait 3s\nshow\n"
PROGRAM_42 = "O0042\nG50 X100 Z100\nG00 X50 Z50\nM30\n"


def lines(text):
    return [line.rstrip() for line in text.rstrip().splitlines()]


async def golden_text(browser, address, seconds):
    """Opens a page of the test session and returns what it prints."""
    await browser.go(address)
    for _ in range(seconds * 5):
        text = await browser.js("document.getElementById('golden').textContent")
        if text:
            return text.strip()
        await asyncio.sleep(0.2)
    raise SystemExit(f"{browser.name}: {address} prints nothing: {browser.said}")


def golden_page(files=()):
    """A page that runs the test session, or marks and replays files."""
    text = "".join(f"{path.name} {path.read_bytes().hex()}\n" for path in files)
    return (
        f'<!DOCTYPE html><pre id="files" hidden>{text}</pre><pre id="golden"></pre>'
        '<script type="module">import start from "./golden.js"; await start();</script>\n'
    )


class MarkedSolutions:
    """The solutions of the exercises, and what this system says about them."""

    def __init__(self, linux, golden, check, wanted=()):
        self.check = check
        self.groups = {}
        folder = Path(tempfile.mkdtemp(prefix="page-marks-"))
        with ThreadPoolExecutor(2) as pool:
            results = marks_check.solve_all([linux], folder / "linux", wanted, pool)
        for result in results:
            files = self.groups.setdefault(result.name.split(".")[0], [])
            files += [result, result.with_suffix(".gskrec")]
        self.expected = {
            name: json.loads(subprocess.run([golden, *files], check=True, capture_output=True).stdout)
            for name, files in self.groups.items()
        }
        for name, files in self.groups.items():
            (check / f"marks-{name}.html").write_text(golden_page(files))
        shutil.rmtree(folder)

    async def compare(self, browser, base):
        """Marks and replays everything in a browser; prints a hash for each file."""
        count = 0
        for name, expected in self.expected.items():
            found = json.loads(await golden_text(browser, f"{base}/check/marks-{name}.html", 600))
            if found != expected:
                raise SystemExit(f"{browser.name}: {name} is marked\n{found}\ninstead of\n{expected}")
            for mark, replay in zip(found["marks"], found["replays"]):
                count += 1
                if not mark["valid"] or replay["differs_at"] or replay["error"]:
                    raise SystemExit(f"{browser.name}: {mark}\n{replay}")
                hashes = f"mark {marks_check.hash_mark(mark)}, state {replay['end']}"
                print(f"{browser.name}: {mark['file']}: {mark['points']}/{mark['max']}, {hashes}", flush=True)
        print(f"{browser.name}: {count} marks and replays are those of this system")


async def check_session(browser, base, golden):
    """Compares the hashes of every tick of the test session."""
    name = browser.name
    hashes = await golden_text(browser, f"{base}/check/golden.html", 20)
    if hashes != golden:
        raise SystemExit(f"{name}: the session hashes to\n{hashes}\ninstead of\n{golden}")
    print(f"{name}: {hashes.split('ticks: ')[1].rstrip(' }')} ticks hash as on this system")


async def use(browser, base, check, expected_lcd):
    """Uses the page by mouse, finger, keys and files."""
    name = browser.name
    page = f"{base}/page/index.html?lang=en&first-start=off"
    await browser.go(page)
    await browser.until("power-on", lambda text: "现在位置" in text)
    await browser.press(SAMPLES)
    await browser.press(FIRST_SAMPLE)
    await browser.until("the sample", lambda text: "O0001" in text)
    await browser.press(AUTO)
    await browser.until("automatic operation", lambda text: "自动方式" in text)
    await browser.press(START, "touch")
    await browser.until("a feed", lambda text: "S0800" in text and "编程速率:     120" in text)
    rate = await browser.js(
        "new Promise(done => { let count = 0; const begun = performance.now();"
        " function frame() { count += 1; const now = performance.now();"
        " if (now - begun > 4000) done(count / (now - begun) * 1000);"
        " else requestAnimationFrame(frame); } requestAnimationFrame(frame); })"
    )
    await browser.picture(check / f"{name}-cutting.png")
    print(f"{name}: {rate:.0f} frames/s while it cuts")

    # The machine continues while another tab is active.
    def cut(text):
        hours, minutes, seconds = text.split("切削时间:")[1].split()[0].split(":")
        return int(hours) * 3600 + int(minutes) * 60 + int(seconds)

    before, begun = cut(await browser.lcd()), time.monotonic()
    other = (await browser.ask("browsingContext.create", type="tab"))["context"]
    await asyncio.sleep(6)
    if not await browser.js("document.hidden"):
        raise SystemExit(f"{name}: the page is not hidden by another tab")
    # A second page on the same memory is refused.
    await browser.go(page, other)
    said = "document.getElementById('said').textContent"
    for _ in range(100):
        if not await browser.js(said, other):
            break
        await asyncio.sleep(0.2)
    else:
        raise SystemExit(f"{name}: in a second tab no window opens: {await browser.js(said, other)}")
    await asyncio.sleep(2)
    if await browser.lcd(other):
        raise SystemExit(f"{name}: two pages work on one memory")
    await browser.ask("browsingContext.close", context=other)
    await browser.ask("browsingContext.activate", context=browser.tab)
    await asyncio.sleep(1)
    went, passed = cut(await browser.lcd()) - before, time.monotonic() - begun
    print(f"{name}: hidden the machine went on by {went} s in {passed:.0f} s")
    if went < 0.6 * passed:
        raise SystemExit(f"{name}: behind another tab the machine stands still")

    await browser.press(SPEED)
    await browser.press(FASTEST)
    done = lambda text: "加工件数:      1" in text
    text = await browser.until("the end of the program", done, 120)
    await asyncio.sleep(2)
    text = await browser.lcd()
    if lines(text) != lines(expected_lcd):
        raise SystemExit(f"{name}: the LCD is\n{text}\ninstead of\n{expected_lcd}")
    await browser.picture(check / f"{name}-cut.png")
    print(f"{name}: the LCD is that of the same keys on this system")

    await browser.key(PAGE_DOWN)
    await browser.until("the next page", lambda text: "绝对坐标" in text)
    await browser.press(PROGRAM, "touch")
    await browser.until("the program page", lambda text: "程序" in text.splitlines()[0])
    await browser.press(POSITION)

    # Files by drop, dialog and link; the memory is kept after the page is closed.
    dropped = json.dumps(PROGRAM_42)
    await browser.js(
        f"(() => {{ const data = new DataTransfer(); data.items.add(new File([{dropped}], 'a.CNC'));"
        " document.getElementById('panel').dispatchEvent(new DragEvent('drop',"
        " { dataTransfer: data, bubbles: true, cancelable: true })); })()"
    )
    await browser.until("the dropped file", lambda text: "O0042" in text)
    chosen = check / "b.CNC"
    chosen.write_text(PROGRAM_42.replace("0042", "0043"))
    await browser.press(OPEN)
    try:
        dialog = await asyncio.wait_for(browser.dialogs.get(), 10)
    except asyncio.TimeoutError:
        raise SystemExit(f"{name}: no dialog for files comes")
    if "element" in dialog:
        await browser.ask(
            "input.setFiles", context=browser.tab, element=dialog["element"], files=[str(chosen)]
        )
        await browser.until("the chosen file", lambda text: "O0043" in text)
        kept = 3
    else:
        kept = 2
        print(f"{name}: a dialog for files comes; this browser does not let it be answered")
    await asyncio.sleep(1)
    await browser.go(f"{base}/page/index.html")
    await browser.until("power-on again", lambda text: "O004" in text)
    names = await browser.js(
        "Object.keys(localStorage).filter(it => it.endsWith('CNC')).sort().join(' ')"
    )
    await browser.go(f"{base}/page/index.html?open=../check/c.CNC")
    await browser.until("the file of the link", lambda text: "O0044" in text)
    numbers = {word.rsplit("/", 1)[-1] for word in names.split()}
    if len(numbers) < kept:
        raise SystemExit(f"{name}: of {kept} programs the browser keeps {numbers}")
    print(f"{name}: files come by drop, dialog and link; {len(numbers)} programs are kept")
    if browser.said:
        raise SystemExit(f"{name}: the page says {browser.said}")


# Takes the WebGL context from the page, and gives it back a moment later.
LOSE_CONTEXT = """(() => {
    window.isOld = true;
    const context = document.getElementById("panel").getContext("webgl2");
    const loss = context.getExtension("WEBGL_lose_context");
    setTimeout(() => loss.restoreContext(), 200);
    loss.loseContext();
    return document.getElementById("said").textContent;
})()"""


async def lose_context(browser, base, losses):
    """Takes the WebGL context from the page several times: it comes back with its memory."""
    await browser.go(f"{base}/page/index.html?lang=en&first-start=off")
    before = await browser.until("a program", lambda text: "O004" in text)
    longest, memory = 0, []
    for _ in range(losses):
        await asyncio.sleep(1)
        lost = time.monotonic()
        await browser.js(LOSE_CONTEXT)
        for _ in range(300):
            await asyncio.sleep(0.2)
            try:
                if not await browser.js("window.isOld ?? false") and await browser.lcd():
                    break
            except RuntimeError:
                pass  # The page is about to change.
        after = await browser.until("the program", lambda text: "O004" in text)
        if lines(after)[0] != lines(before)[0]:
            raise SystemExit(f"{browser.name}: after the loss of the context the LCD is\n{after}")
        longest = max(longest, time.monotonic() - lost)
        memory.append(browser.memory_mb())
    print(
        f"{browser.name}: {losses} losses of the context, the page is back within {longest:.1f} s;"
        f" memory {memory[0]} MB after the first, {memory[-1]} MB after the last, at most {max(memory)} MB"
    )
    if losses > 10 and memory[-1] > 1.5 * max(memory[:10]):
        raise SystemExit(f"{browser.name}: the memory grows: {memory}")


async def main():
    page, check, linux, golden = (Path(word).resolve() for word in sys.argv[1:5])
    served = Path(tempfile.mkdtemp(prefix="page-served-"))
    (served / "page").symlink_to(page)
    (served / "check").symlink_to(check)
    (check / "golden.html").write_text(golden_page())
    (check / "c.CNC").write_text(PROGRAM_42.replace("0042", "0044"))
    handler = functools.partial(Quiet, directory=str(served))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    base = f"http://127.0.0.1:{server.server_port}"

    said = subprocess.run([golden], check=True, capture_output=True, text=True).stdout.strip()
    script = check / "page.operate"
    script.write_text(SCRIPT)
    sample = "01-stepped-shaft.CNC"
    shutil.copy(ROOT / "assets/programs" / sample, check / sample)
    shown = subprocess.run([linux, "operate", script], check=True, capture_output=True, text=True)
    sizes = ", ".join(f"{it.name} {it.stat().st_size // 1000} kB" for it in sorted(page.iterdir()))
    print(f"the page: {sizes}")
    solutions = MarkedSolutions(linux, golden, check)
    for name in sys.argv[5:] or ["chromium", "firefox"]:
        browser = Browser(name)
        await browser.start()
        try:
            await check_session(browser, base, said)
            await use(browser, base, check, shown.stdout)
            await lose_context(browser, base, int(os.environ.get("LOSSES", "3")))
            await solutions.compare(browser, base)
        finally:
            await browser.end()
    shutil.rmtree(served)


if __name__ == "__main__":
    asyncio.run(main())
