"""The rules of the house that no other program knows: sizes, and who may include whom."""

import collections
import re

from files import CPP, ROOT, all_files

LONGEST_FILE = 350  # lines
FULLEST_FOLDER = 12  # sources and headers
LONG_FOR_A_REASON = "Over 350 lines: "  # then the reason, in the first lines of the file
HEAD = 12  # lines

# What a package may include besides itself.
MAY_INCLUDE = {
    "auv_common": set(),
    "auv_dynamics": {"auv_common"},
    "acoustic_channel": {"auv_common"},
    "stg_agent": {"auv_common", "auv_dynamics", "acoustic_channel"},
    "marl_trainer": {"auv_common", "auv_dynamics", "acoustic_channel", "stg_agent"},
    "stg_bringup": {"auv_common", "auv_dynamics", "acoustic_channel", "stg_agent", "marl_trainer"},
}
# Headers that a core must not see.
ROS = re.compile(
    r"(ros|rosbag|rosgraph_msgs|diagnostic_updater|tf2|tf2_\w+|std_srvs|\w+_msgs)/|.*/nodes/"
)
INCLUDE = re.compile(r"\s*#\s*include\s*[<\"]([^>\"]+)[>\"]")


def is_core(path):
    """Whether a file, as a path from src/, belongs to the core of its package."""
    parts = path.parts
    return (
        len(parts) > 2
        and parts[1] in ("include", "src")
        and parts[2] != "nodes"
        and parts[0] != "stg_bringup"
    )


def forbidden(path, header, packages):
    """Returns why the file at `path` (from src/) may not include `header`, or None."""
    package = path.parts[0]
    other = header.split("/")[0]
    if is_core(path) and ROS.match(header):
        return "the core needs neither ROS nor messages"
    if other in packages and other != package and other not in MAY_INCLUDE.get(package, packages):
        return f"{package} does not build on {other}"
    return None


def check_includes(source=ROOT / "src"):
    """Looks for includes against the order of the packages, or of ROS by a core, below `source`."""
    packages = set(MAY_INCLUDE)
    findings = []
    files = [p for p in sorted(source.rglob("*")) if p.suffix in CPP and p.is_file()]
    for file in files:
        path = file.relative_to(source)
        text = file.read_text(encoding="utf-8", errors="replace")
        for number, line in enumerate(text.splitlines(), start=1):
            match = INCLUDE.match(line)
            reason = match and forbidden(path, match.group(1), packages)
            if reason:
                findings.append(f"src/{path}:{number}: {match.group(1)}: {reason}")
    return f"{len(files)} files", findings


def check_sizes():
    """Looks for files that are too long without a reason, and folders that are too full."""
    findings = []
    folders = collections.Counter()
    files = [p for p in all_files() if p.parts[0] == "src" and p.suffix in CPP | {".py"}]
    for path in files:
        lines = (ROOT / path).read_text(encoding="utf-8", errors="replace").splitlines()
        if len(lines) > LONGEST_FILE and LONG_FOR_A_REASON not in "\n".join(lines[:HEAD]):
            findings.append(f"{path}: {len(lines)} lines, and no '{LONG_FOR_A_REASON}' in its head")
        if path.suffix in CPP:
            folders[path.parent] += 1
    for folder, count in sorted(folders.items()):
        if count > FULLEST_FOLDER:
            findings.append(f"{folder}: {count} sources and headers, more than {FULLEST_FOLDER}")
    return f"{len(files)} files in {len(folders)} folders", findings
