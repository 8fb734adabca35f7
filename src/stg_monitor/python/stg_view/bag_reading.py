"""Reads bags that may be damaged. Every problem is a BagError with a message for the user."""

import contextlib
import io
import os
import shutil
import sys
import tempfile

import rosbag


class BagError(Exception):
    """The reason why a bag cannot be read, as a message for the user."""


def open_bag(path, salvage):
    """Opens a bag for reading; with `salvage`, the intact part of a truncated bag."""
    if not os.path.exists(path):
        raise BagError(f"{path}: no such file")
    if os.path.isdir(path):
        raise BagError(f"{path}: is a folder, not a bag")
    if not os.path.isfile(path):
        raise BagError(f"{path}: is not a regular file")
    if os.path.getsize(path) == 0:
        raise BagError(f"{path}: is empty")
    try:
        return rosbag.Bag(path)
    except rosbag.ROSBagUnindexedException:
        if salvage:
            return salvaged(path)
        raise BagError(
            f"{path}: is truncated or was not closed (it has no index);"
            " --salvage reads its complete part"
        ) from None
    except Exception as error:  # damage may raise any error in rosbag
        if salvage and looks_like_bag(path):
            return salvaged(path)
        raise BagError(
            f"{path}: cannot be read as a bag: {type(error).__name__}: {error}"
        ) from None


def looks_like_bag(path):
    """True if a file starts as bags do."""
    with open(path, "rb") as bag:
        return bag.read(13) == b"#ROSBAG V2.0\n"


def salvaged(path):
    """Indexes a copy of a truncated bag and opens the copy. The bag itself stays unchanged."""
    folder = tempfile.mkdtemp(prefix="bag_report_")
    try:
        copy = os.path.join(folder, "salvaged.bag")
        shutil.copyfile(path, copy)
        with rosbag.Bag(copy, "a", allow_unindexed=True) as bag:
            for _ in bag.reindex():
                pass
        print(f"bag_report: {path} is truncated; reading its complete part", file=sys.stderr)
        return rosbag.Bag(copy)
    except Exception as error:  # damaged data may raise any error in rosbag
        raise BagError(f"{path}: no part of it can be read: {error}") from None
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def messages(bag, path):
    """Yields (topic, message); damage inside the bag becomes a BagError."""
    reader = bag.read_messages()
    while True:
        said = io.StringIO()  # if a definition does not fit its checksum, rosbag prints this and continues
        try:
            with contextlib.redirect_stderr(said):
                found = next(reader, None)
        except Exception as error:  # damaged chunks raise many errors, from struct.error to those of bz2
            raise BagError(f"{path}: is damaged: {type(error).__name__}: {error}") from None
        if said.getvalue():
            raise BagError(f"{path}: is damaged: {said.getvalue().splitlines()[0]}")
        if found is None:
            return
        yield found[0], found[1]
