"""How soon does the exported page show its robot, and how smoothly does it move? In headless Chromium."""

import shutil
import tempfile
import time
from pathlib import Path
from statistics import median

import parflex as pf
from benchmarks.report import Section
from parflex.app import paper

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
ARGUMENTS = ["--no-sandbox", "--enable-unsafe-swiftshader"]
SIZE = {"width": 1280, "height": 720}
TURNS = 5
WATCHED = 3.0  # s


def ask() -> Section:
    """The paper's run as one file, opened offline under software rendering, a fresh browser each turn."""
    section = Section(
        "The viewer: the paper's run, 1280 × 720, software rendering", ("what", "found", "asked")
    )
    if CHROMIUM is None:
        section.notes = ["not measured: there is no chromium here (apt-get install chromium)"]
        return section
    with tempfile.TemporaryDirectory() as folder:
        path = pf.view(paper.run(10).result).save(Path(folder) / "robot.html")
        found = [opened(path) for _ in range(TURNS)]
        size = path.stat().st_size
    first, rate = (median(values) for values in zip(*found, strict=True))
    section.add("size of the file, MB", f"{size / 1e6:.2g}", "≤ 6")
    section.add("first picture after, s", f"{first:.2f}", "≤ 3")
    section.add("frames a second", f"{rate:.1f}", "≥ 20")
    section.notes = [f"medians of {TURNS} fresh browsers"]
    return section


def opened(path: Path) -> tuple[float, float]:
    """Seconds to the first picture, and frames a second while the robot moves."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        page = browser.new_context(viewport=SIZE, offline=True).new_page()
        page.goto(path.as_uri())
        page.wait_for_function("window.parflex?.state.firstPicture", timeout=60_000)
        first = page.evaluate("parflex.state.firstPicture") / 1e3
        page.wait_for_timeout(1000)
        frames, start = page.evaluate("parflex.state.frames"), time.perf_counter()
        page.wait_for_timeout(1e3 * WATCHED)
        rate = (page.evaluate("parflex.state.frames") - frames) / (time.perf_counter() - start)
        browser.close()
    return first, rate
