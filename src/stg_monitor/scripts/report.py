#!/usr/bin/python3
"""Makes one HTML file of a run, which opens in any browser with the network off.

RUN is a bag of record:=true, a folder of `evaluate --record`, of `simulate` or of a training, a
packet log (.csv), or a recording (.stgv). Scene, time with events, plots, table and network are in
the page; README and docs/view.md say how to read it.

Exit status: 0 done, 1 nothing of a run in it, 2 wrong usage, or a file that cannot be read or written.
"""

import argparse
import os
import pathlib
import sys

from stg_common.files import FileError
from stg_common.program import run_program
from stg_common.stated import stated
from stg_view.browser import BrowserError
from stg_view.from_folder import read_folder
from stg_view.page import PageError, report_page, write_page
from stg_view.video import frame_size, write_video


def parse_arguments(arguments):
    """Returns the parsed command line."""
    parser = argparse.ArgumentParser(
        prog="report", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("run", metavar="RUN", help="bag, folder, packet log or recording")
    parser.add_argument("--out", "-o", metavar="FILE", help="page to write (default: RUN.html)")
    parser.add_argument("--title", help="title of the page (default: the name of RUN)")
    parser.add_argument("--salvage", action="store_true", help="read the undamaged part of a damaged bag")
    parser.add_argument("--video", metavar="FILE", help="write a video (.mp4, .webm or .gif), too")
    parser.add_argument("--video-seconds", type=float, default=12.0, help="length of the video (default: 12)")
    parser.add_argument("--video-size", default="1280x720", help="size of the video (default: 1280x720)")
    parser.add_argument("--video-theme", choices=["light", "dark"], default="dark")
    options = parser.parse_args(arguments)
    if not options.video:
        for name in sorted(stated(parser, arguments)):
            if name.startswith("video_"):
                parser.error(f"--{name.replace('_', '-')} has no effect without --video")
    return options


def read_any(path, salvage, title):
    """The bytes of a recording, whatever `path` is."""
    with_magic = b""
    if os.path.isfile(path):
        with open(path, "rb") as file:
            with_magic = file.read(13)
    if path.endswith(".bag") or with_magic.startswith(b"#ROSBAG"):
        from stg_view.from_bag import read_bag  # needs rosbag; other runs do not need it

        return read_bag(path, salvage, title)
    if not os.path.exists(path):
        raise FileError(path, "no such file or folder")
    if salvage:
        raise FileError(path, "--salvage has no effect, because this is no bag")
    return read_folder(path)


def main(arguments=None):
    """Runs the tool; returns the exit status."""
    options = parse_arguments(arguments)
    name = pathlib.Path(options.run).resolve().name
    title = options.title or name
    if options.video:
        # Now, because making the page may take minutes.
        frame_size(options.video, options.video_seconds, options.video_size)
    try:
        recording = read_any(options.run, options.salvage, title)
    except LookupError as error:
        print(f"report: {error.args[0]}", file=sys.stderr)
        return 1
    out = options.out or f"{options.run.rstrip('/')}.html"
    write_page(report_page(recording, title, is_chosen=options.title is not None), out)
    print(f"report: {out}, {os.path.getsize(out) / 1e6:.1f} MB")
    if options.video:
        write_video(out, options.video, options.video_seconds, options.video_size, options.video_theme)
        print(f"report: {options.video}")
    return 0


def refusals():
    """Errors of a run that cannot be read; bags need ROS."""
    try:
        from stg_view.bag_reading import BagError
    except ImportError:
        return (PageError, BrowserError)
    return (PageError, BrowserError, BagError)


if __name__ == "__main__":
    run_program("report", main, *refusals())
