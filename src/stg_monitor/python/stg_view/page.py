"""The page as one HTML file. Everything is inlined, and it needs no other host.

The content security policy has the hash of every script and style, so the page runs nothing else: no text of
a recording can become code. The recording is data in base64.
"""

import base64
import gzip
import hashlib
import html
import os
import pathlib

__all__ = ["PageError", "live_page", "report_page"]

WEB = pathlib.Path(__file__).resolve().parent / "web"
# Folder of three.js: beside the page, or that of Debian's libjs-three.
THREE = (WEB / "vendor" / "three", pathlib.Path("/usr/share/javascript/three"))
THREE_FILES = ("build/three.min.js", "examples/js/controls/OrbitControls.js")
SCRIPTS = ("recording", "story", "shapes", "lines", "camera", "scene", "sound", "plots", "network", "table", "overlay", "app")


class PageError(Exception):
    """The reason why a page cannot be made."""


def _read(path):
    return path.read_text(encoding="utf-8")


def _three():
    folder = next((f for f in THREE if (f / THREE_FILES[0]).is_file()), None)
    if folder is None:
        raise PageError(f"no three.js in {' or '.join(map(str, THREE))}: install Debian's libjs-three")
    return [_read(folder / name) for name in THREE_FILES]


def _hash(text):
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"


def _page(title, data, connect):
    scripts = [*_three(), _read(WEB / "vendor/uplot/uPlot.iife.min.js")]
    scripts += [_read(WEB / f"{name}.js") for name in SCRIPTS]
    # Such a text would end the element early and change the page. Our scripts and the libraries have none.
    if any("</script" in text.lower() for text in scripts):
        raise PageError("the text of a script contains </script")
    styles = [_read(WEB / "vendor/uplot/uPlot.min.css"), _read(WEB / "style.css")]
    policy = (
        f"default-src 'none'; script-src {' '.join(map(_hash, scripts))}; "
        f"style-src {' '.join(map(_hash, styles))}; img-src data: blob:; connect-src {connect}; "
        "base-uri 'none'; form-action 'none'"
    )
    parts = {
        "@CSP@": f'<meta http-equiv="Content-Security-Policy" content="{policy}">',
        "@TITLE@": html.escape(title),
        "@STYLES@": "\n".join(f"<style>{text}</style>" for text in styles),
        "@SCRIPTS@": "\n".join(f"<script>{text}</script>" for text in scripts),
        "@DATA@": data,
    }
    text = _read(WEB / "page.html")
    # Goes through the template once. Inserted text is not processed again.
    pieces = []
    while True:
        at, mark = min(((text.find(m), m) for m in parts if m in text), default=(-1, ""))
        if at < 0:
            return "".join([*pieces, text])
        pieces += [text[:at], parts[mark]]
        text = text[at + len(mark) :]


def report_page(recording, title, is_chosen=False):
    """HTML of a report. recording: its bytes. title: plain text; unless it was chosen, the title in the
    recording replaces it."""
    packed = base64.b64encode(gzip.compress(recording, 9, mtime=0)).decode()
    data = f'<script type="application/octet-stream" id="recording">{packed}</script>'
    return _page(title, data + '<meta id="titled">' * is_chosen, "'none'")


def live_page(title):
    """HTML of the page of a live run, which follows the websocket /stream of its own host."""
    return _page(title, '<meta id="socket">', "'self'")


def write_page(text, path):
    """Writes the page. The old file stays until the new one is complete."""
    temporary = f"{path}.tmp"
    try:
        with open(temporary, "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(temporary, path)
    except OSError as error:
        raise PageError(f"{path}: cannot write the page: {error.strerror}") from None
