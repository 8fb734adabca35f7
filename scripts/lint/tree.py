"""The C++ sources below src/: to which package and subject each belongs, and what it includes."""

import pathlib
import re
import typing

CPP = {".cpp", ".hpp"}
INCLUDE = re.compile(r"\s*#\s*include\s*[<\"]([^>\"]+)[>\"]")


class Include(typing.NamedTuple):
    """One line `#include`: in `file`, a path from src/, of `header` as the line names it."""

    file: pathlib.Path
    line: int
    header: str


def read(path):
    """Returns the text of a file, whatever its bytes."""
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
    """Returns a file's path as an #include names it: package, subjects, name.

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
    """Returns what `include` names as `logical` does, whether given from the package or from the
    file's own folder."""
    beside = source / include.file.parent / include.header
    if beside.is_file():
        file, inside = beside.resolve(), source.resolve()
        if inside not in file.parents:
            return pathlib.PurePosixPath(file.relative_to(inside.parent))  # such as cmake/x.h
        return logical(file.relative_to(inside))
    return pathlib.PurePosixPath(include.header)
