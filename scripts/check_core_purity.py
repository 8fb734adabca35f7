#!/usr/bin/python3
"""Fails when the pure core of a package includes a ROS header or a message.

Usage: check_core_purity.py [SOURCE_FOLDER]. The core is everything under <package>/include and
<package>/src except <package>/src/nodes. Each offending line is printed as FILE:LINE: TEXT.
"""

import pathlib
import re
import sys

INCLUDE = re.compile(
    r"\s*#\s*include\s*[<\"]"
    r"(ros/|rosbag/|tf2?(_ros|_eigen|_geometry_msgs)?/|diagnostic_updater/|[a-z0-9_]+_msgs/|std_srvs/)"
)
SUFFIXES = {".h", ".hpp", ".hh", ".c", ".cc", ".cpp", ".cxx", ".inl", ".ipp", ".tpp"}


def core_files(source):
    """Yields every C++ file of the core below `source`."""
    for package in sorted(path.parent for path in source.glob("*/package.xml")):
        for folder in ("include", "src"):
            for path in sorted((package / folder).rglob("*")):
                in_nodes = (package / "src" / "nodes") in path.parents
                if path.suffix in SUFFIXES and not in_nodes:
                    yield path


def violations(source):
    """Returns one "FILE:LINE: TEXT" for each forbidden include below `source`."""
    found = []
    for path in core_files(source):
        lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
        for number, line in enumerate(lines, start=1):
            if INCLUDE.match(line):
                found.append(f"{path.relative_to(source)}:{number}: {line.strip()}")
    return found


def main():
    """Checks the folder given on the command line, or the repository's own src/."""
    default = pathlib.Path(__file__).resolve().parents[1] / "src"
    found = violations(pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else default)
    for line in found:
        print(line)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
