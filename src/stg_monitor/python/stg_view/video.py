"""Videos of a page: Chromium draws the frames, and ffmpeg puts them together."""

import pathlib
import shutil
import subprocess

from stg_view.browser import BrowserError, opened_page

__all__ = ["frame_size", "write_video"]

FRAMES_PER_S = 20
GIF_COLOURS = "split[a][b];[a]palettegen=max_colors=128[p];[b][p]paletteuse=dither=bayer"
OUTPUT = {
    ".mp4": ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "23", "-movflags", "+faststart"],
    ".webm": ["-c:v", "libvpx-vp9", "-crf", "34", "-b:v", "0"],
    ".gif": ["-vf", GIF_COLOURS],
}


def frame_size(out, seconds, size):
    """Returns (width, height) in pixels. Refuses a video that cannot be made."""
    if pathlib.Path(out).suffix not in OUTPUT:
        raise BrowserError(f"{out}: a video ends in {', '.join(OUTPUT)}")
    if not shutil.which("ffmpeg"):
        raise BrowserError("a video needs ffmpeg: install ffmpeg")
    try:
        width, height = (int(x) // 2 * 2 for x in size.split("x"))
    except ValueError:
        raise BrowserError(f"'{size}' is not a size such as 1280x720") from None
    if not (0.1 <= seconds <= 600 and 200 <= width <= 4096 and 200 <= height <= 4096):
        raise BrowserError("a video takes 0.1 to 600 seconds and 200 to 4096 pixels")
    return width, height


def write_video(page, out, seconds, size, theme="dark", camera="swarm", tab="story", span=(0.0, 1.0), rate=FRAMES_PER_S):
    """Films a page from disk in `seconds`. span: the part of the run as two shares of it."""
    width, height = frame_size(out, seconds, size)
    command = ["ffmpeg", "-v", "error", "-y", "-f", "image2pipe", "-c:v", "mjpeg", "-r", str(rate), "-i", "-",
               *OUTPUT[pathlib.Path(out).suffix], out]  # fmt: skip
    url = pathlib.Path(page).resolve().as_uri() + f"#theme={theme}&camera={camera}&tab={tab}"
    with opened_page(url, width, height) as driver:
        film = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE)
        try:
            for picture in pictures(driver, max(2, round(seconds * rate)), span):
                film.stdin.write(picture)
            film.stdin.close()
        except BrokenPipeError:
            pass
        with film.stderr:
            said = film.stderr.read().decode("utf-8", "replace").strip()
        if film.wait() != 0:
            raise BrowserError(f"{out}: ffmpeg cannot write it: {said.splitlines()[-1] if said else 'no reason'}")


def pictures(driver, count, span):
    """Yields the frames as JPEG, evenly spread over the run."""
    import base64

    driver.execute_script("STG.app.playing = false; STG.app.speed = STG.app.pace()")
    for k in range(count):
        share = span[0] + (span[1] - span[0]) * k / (count - 1)
        driver.execute_script(
            "const a = STG.app, r = a.recording; a.t = r.start + arguments[0] * (r.end - r.start);"
            "a.draw(performance.now())",
            share,
        )
        shot = driver.execute_cdp_cmd("Page.captureScreenshot", {"format": "jpeg", "quality": 88})
        yield base64.b64decode(shot["data"])
