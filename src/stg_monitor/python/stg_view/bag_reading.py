"""Reading of bags that may be damaged: whatever is wrong with one is a BagError, which says it in words."""

import contextlib
import io
import os
import shutil
import sys
import tempfile

import rosbag


class BagError(Exception):
    """A bag that cannot be read, in words for the user."""


def open_bag(path, salvage):
    """Opens a bag for reading; with `salvage`, what is whole of a truncated one."""
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
    except Exception as error:  # damage raises whatever rosbag trips over
        if salvage and looks_like_bag(path):
            return salvaged(path)
        raise BagError(
            f"{path}: cannot be read as a bag: {type(error).__name__}: {error}"
        ) from None


def looks_like_bag(path):
    """True when a file starts as bags do."""
    with open(path, "rb") as bag:
        return bag.read(13) == b"#ROSBAG V2.0\n"


def salvaged(path):
    """Indexes a copy of a truncated bag and opens that; the bag itself is left as it is."""
    folder = tempfile.mkdtemp(prefix="bag_report_")
    try:
        copy = os.path.join(folder, "salvaged.bag")
        shutil.copyfile(path, copy)
        with rosbag.Bag(copy, "a", allow_unindexed=True) as bag:
            for _ in bag.reindex():
                pass
        print(f"bag_report: {path} is truncated; reading its complete part", file=sys.stderr)
        return rosbag.Bag(copy)
    except Exception as error:  # rosbag raises whatever it trips over in damaged data
        raise BagError(f"{path}: no part of it can be read: {error}") from None
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def messages(bag, path):
    """Yields (topic, message); damage inside the bag becomes a BagError."""
    reader = bag.read_messages()
    while True:
        said = io.StringIO()  # where a definition does not fit its checksum, rosbag says so, goes on
        try:
            with contextlib.redirect_stderr(said):
                found = next(reader, None)
        except Exception as error:  # damaged chunks raise anything from struct.error to bz2's
            raise BagError(f"{path}: is damaged: {type(error).__name__}: {error}") from None
        if said.getvalue():
            raise BagError(f"{path}: is damaged: {said.getvalue().splitlines()[0]}")
        if found is None:
            return
        yield found[0], found[1]
