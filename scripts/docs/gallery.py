#!/usr/bin/python3
"""Makes the gallery: pictures and short videos of the view, and the page docs/gallery.md that shows them.

Flies the runs, makes their reports and opens them in Chromium; needs ./stg build, ffmpeg, no display
and no ROS. Names choose pictures and videos (default: all).
"""

import argparse
import base64
import pathlib
import shlex
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

from stg_view.browser import show, started
from stg_view.video import write_video

DOCS = ROOT / "docs"
IMAGES = DOCS / "images"
# run: title of its page, and command; OUT stands for the folder of the recording
EVALUATE = "rosrun marl_trainer evaluate --episodes 1 --record OUT"
RUNS = {
    "field20": ("Twenty over a ridge", f"{EVALUATE} --scenario field20 --policy encircle"),
    "loss": ("A loss under stress", f"{EVALUATE} --scenario field --condition combined_stress --policy encircle"),
    "search": ("Four look for a target", f"{EVALUATE} --scenario search --policy search_map"),
    "hunt": ("A target that flees", f"{EVALUATE} --scenario hunt --policy src/stg_bringup/policies/field.onnx"),
    "many": ("Eight on three targets", f"{EVALUATE} --scenario many8 --policy encircle"),
    "medium": ("The paper's box", f"{EVALUATE} --scenario medium --policy pursuit_separated"),
    "network": ("A network alone", "rosrun acoustic_channel simulate src/acoustic_channel/networks/survey.yaml --out OUT"),
    "training": ("A training", "rosrun marl_trainer train --scenario medium_separated --steps 200000 --out OUT"),
}
LOSS = "[...document.querySelectorAll('.event')].filter(b => b.textContent.includes('loses'))[1].click();"
# name: run, place in the page, width, height, script that runs first, title, caption
PICTURES = {
    "view_field20": ("field20", "t=200&theme=dark&tab=network", 1280, 720, "", "Twenty over a ridge",
        "Twenty torpedoes over the bathymetry of the paper's Fig. 6. Colours are phases: AUVs search for the target (blue), approach it (yellow) and "
        "stay at their distance (green). On the right: the transmissions of each AUV, in time slots, one after the other."),
    "view_search": ("search", "t=700&theme=dark&tab=story&camera=above", 1280, 720, "", "A search",
        "Four AUVs that were launched in one place sweep the water around an old datum. The large circle is their estimate of the target; red means "
        "that they have lost the target, or have not found it yet."),
    "view_hunt": ("hunt", "t=1500&theme=light&tab=plots&camera=target", 1280, 720, "", "A target that flees",
        "The target is nearly as fast as the AUVs; the policy over entities keeps a ring around it. The buttons above the plots choose an AUV."),
    "view_many": ("many", "t=400&theme=light&tab=table&camera=region", 1280, 720, "", "Several targets",
        "Eight AUVs and three targets. A broken line leads from each AUV to the target that it follows; the table contains this target, too."),
    "view_medium": ("medium", "t=3.2&theme=light&tab=plots", 1280, 720, "", "The paper's box",
        "Four AUVs in a box of 2 m approach to 15 mm. A vertical line marks the time in all plots."),
    "view_loss": ("loss", "theme=light", 1280, 720, LOSS, "A loss, and why",
        "The page shows the reasons of an event. [The tutorial](tutorials/lost_target.md) explains how to read them within a minute."),
    "view_loss_network": ("loss", "theme=light", 1280, 720, LOSS + "STG.app.show('network')", "The network at the same moment",
        "Bars are transmissions; the filled part is the share of receivers that received them. Marks are receivers that missed a "
        "transmission, in the colour of the reason."),
    "view_network": ("network", "theme=dark&tab=network", 1280, 720, "", "A network alone",
        "The results of `simulate`: a buoy, moored nodes and vehicles share the water, without any agent."),
    "view_training": ("training", "theme=light", 1280, 720, "", "A training", "The curves of a training's folder."),
    "view_phone": ("field20", "t=300&theme=dark&tab=plots&auv=3", 390, 780, "", "On a telephone", "The same page, 390 pixels wide."),
}  # fmt: skip
# name: run, seconds, theme, camera, tab, part of the run as two shares, title, caption
FILMS = {
    "film_medium": ("medium", 2.54, "light", "swarm", "plots", (0.0, 0.1), "The paper's box", "The first five seconds, at twice their speed."),
}
FRAMES_PER_S = 15
INTRO = """\
# Gallery
These pictures show the page of the view, as `./stg report` makes it from a recorded run and `./stg run ... view:=web` shows it live.
[The view](view.md) explains it. `scripts/docs/gallery.py` simulates these runs again and makes all pictures, videos and this page.
"""


def told(run):
    """The commands of a run as a block, in lines that fit a page of the site."""
    command = RUNS[run][1].replace("OUT", f"runs/{run}").replace(" --scenario", " \\\n    --scenario")
    return f"```\n{command}\n./stg report runs/{run}\n```\n"


def page_text():
    """The page in Markdown: each run once, with its videos and pictures."""
    parts, shown = [INTRO], set()
    films = {run: (name, title, text) for name, (run, *_, title, text) in FILMS.items()}
    for name, (run, *_, title, text) in PICTURES.items():
        parts.append(f"## {title}\n{text}\n\n![{title}](images/{name}.jpg)\n")
        if run in shown:
            continue
        shown.add(run)
        if run in films:
            film, film_title, film_text = films[run]
            parts.append(f'<video controls muted loop playsinline width="100%" src="images/{film}.mp4"></video>\n\n'
                         f"[{film_title}](images/{film}.mp4): {film_text[0].lower()}{film_text[1:]}\n")  # fmt: skip
        parts.append(told(run))
    return "\n".join(parts)


def fly(run, folder):
    """Returns the path of a run's page."""
    title, command = RUNS[run]
    page, out = folder / f"{run}.html", folder / run
    if page.is_file():
        return page
    _, package, program, *words = shlex.split(command)
    words = [str(out) if word == "OUT" else word for word in words]
    subprocess.run([ROOT / "devel/lib" / package / program, *words], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run([ROOT / "src/stg_monitor/scripts/report.py", out, "--out", page, "--title", title], check=True)
    return page


def take_pictures(names, folder):
    """Writes pictures with one browser."""
    pages = {name: fly(PICTURES[name][0], folder) for name in names}
    with started() as driver:
        for name, page in pages.items():
            _, place, width, height, script, *_ = PICTURES[name]
            show(driver, f"{page.as_uri()}#{place}", width, height)
            if script:
                driver.execute_script(script)
            driver.execute_async_script("const done = arguments[0]; STG.app.redraw(); setTimeout(done, 1200)")
            shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "jpeg", "quality": 80})
            (IMAGES / f"{name}.jpg").write_bytes(base64.b64decode(shot["data"]))


def main():
    """Makes the requested files."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="names of pictures and videos in docs/images; page: only the page")
    parser.add_argument("--keep", type=pathlib.Path, help="folder that keeps runs and pages for the next call")
    options = parser.parse_args()
    wanted = set(options.names or [*PICTURES, *FILMS, "page"])
    if unknown := wanted - {*PICTURES, *FILMS, "page"}:
        parser.error(f"no {', '.join(sorted(unknown))}; there are {', '.join([*PICTURES, *FILMS, 'page'])}")
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        if chosen := [name for name in PICTURES if name in wanted]:
            take_pictures(chosen, folder)
        for name, (run, seconds, theme, camera, tab, span, *_) in FILMS.items():
            if name in wanted:
                write_video(fly(run, folder), str(IMAGES / f"{name}.mp4"), seconds, "1280x720", theme, camera, tab, span, FRAMES_PER_S)
    (DOCS / "gallery.md").write_text(page_text())


if __name__ == "__main__":
    main()
