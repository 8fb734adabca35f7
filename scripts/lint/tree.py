"""The C++ sources below src/: the package and subject of each, and its includes."""

import pathlib
import re
import typing

CPP = {".cpp", ".hpp"}
INCLUDE = re.compile(r"\s*#\s*include\s*[<\"]([^>\"]+)[>\"]")


class Include(typing.NamedTuple):
    """One line `#include` in `file` (a path from src/), with `header` as written in the line."""

    file: pathlib.Path
    line: int
    header: str


def read(path):
    """Returns the text of a file; invalid bytes are replaced."""
    return path.read_text(encoding="utf-8", errors="replace")


def cpp_files(source):
    """Returns the sorted paths of all C++ files below the folder `source`, relative to it."""
    return sorted(p.relative_to(source) for p in source.rglob("*") if p.suffix in CPP)


def includes(source):
    """Yields every Include of the files below `source`."""
    for file in cpp_files(source):
        for number, line in enumerate(read(source / file).splitlines(), start=1):
            match = INCLUDE.match(line)
            if match:
                yield Include(file, number, match.group(1))


def logical(file):
    """Returns a file's path in the form of an #include: package, subjects, name.

    `p/include/p/a/x.hpp`, `p/src/a/x.cpp` and `p/src/nodes/include/p/nodes/x.hpp` become
    `p/a/x.hpp`, `p/a/x.cpp` and `p/nodes/x.hpp`; tests and benchmarks keep their folder's name.
    """
    parts = file.parts
    if "include" in parts:
        return pathlib.PurePosixPath(*parts[parts.index("include") + 1 :])
    if len(parts) > 1 and parts[1] == "src":
        return pathlib.PurePosixPath(parts[0], *parts[2:])
    return pathlib.PurePosixPath(*parts)


def included(include, source):
    """Returns the path of an include in the form of `logical`. The include may be relative to the package or
    to the folder of its file."""
    beside = source / include.file.parent / include.header
    if beside.is_file():
        file, inside = beside.resolve(), source.resolve()
        if inside not in file.parents:
            return pathlib.PurePosixPath(file.relative_to(inside.parent))  # e.g. cmake/x.h
        return logical(file.relative_to(inside))
    return pathlib.PurePosixPath(include.header)
