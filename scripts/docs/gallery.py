#!/usr/bin/python3
"""Makes the pictures of the view that the documents show, and those of the site's gallery.

Flies the runs, makes their reports and opens them in Chromium; needs ./stg build, no display and no
ROS. Give a folder (default: docs/images); --video makes short videos beside them.
"""

import argparse
import base64
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

from stg_view.browser import opened_page
from stg_view.video import write_video

EVALUATE = ROOT / "devel/lib/marl_trainer/evaluate"
REPORT = ROOT / "src/stg_monitor/scripts/report.py"
RUNS = {
    "field20": ["--policy", "encircle", "--scenario", "field20"],
    "loss": ["--policy", "encircle", "--scenario", "field", "--condition", "combined_stress"],
    "medium": ["--policy", "pursuit_separated", "--scenario", "medium"],
}
TITLES = {"field20": "Twenty over a ridge", "loss": "A loss under stress", "medium": "The paper's box"}
# name: run, place in the page, width, height, what is clicked first
PICTURES = {
    "view_field20": ("field20", "t=200&theme=dark&tab=network&auv=-1", 1280, 720, ""),
    "view_loss": ("loss", "theme=light", 1280, 720, "[...document.querySelectorAll('.event')]"
                  ".filter(b => b.textContent.includes('loses'))[1].click()"),  # fmt: skip
    "view_loss_network": ("loss", "theme=light", 1280, 720, "[...document.querySelectorAll('.event')]"
                          ".filter(b => b.textContent.includes('loses'))[1].click(); STG.app.show('network')"),  # fmt: skip
    "view_medium": ("medium", "t=3.2&theme=light&tab=plots", 1280, 720, ""),
    "view_phone": ("field20", "t=300&theme=dark&tab=plots&auv=3", 390, 780, ""),
}


def make_pages(folder):
    """Returns {run: its page}."""
    pages = {}
    for name, arguments in RUNS.items():
        run = folder / name
        subprocess.run([EVALUATE, *arguments, "--episodes", "1", "--record", run], check=True, stdout=subprocess.DEVNULL)
        pages[name] = folder / f"{name}.html"
        subprocess.run([REPORT, run, "--out", pages[name], "--title", TITLES[name]], check=True)
    return pages


def take_picture(page, place, width, height, click, out):
    """Writes one picture of a page."""
    with opened_page(f"{page.as_uri()}#{place}", width, height) as driver:
        if click:
            driver.execute_script(click)
        driver.execute_async_script("const done = arguments[0]; STG.app.redraw(); setTimeout(done, 1200)")
        shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "jpeg", "quality": 80})
        out.write_bytes(base64.b64decode(shot["data"]))


def main():
    """Makes the pictures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", default=ROOT / "docs/images", type=pathlib.Path)
    parser.add_argument("--video", action="store_true", help="short videos, too")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        pages = make_pages(pathlib.Path(folder))
        for name, (run, place, width, height, click) in PICTURES.items():
            take_picture(pages[run], place, width, height, click, options.folder / f"{name}.jpg")
        if options.video:
            for run, page in pages.items():
                write_video(page, str(options.folder / f"{run}.mp4"), 10.0, "1280x720")


if __name__ == "__main__":
    main()
