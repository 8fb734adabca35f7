"""Runs clang-tidy on all compiled files except tests, and remembers units without findings.

It checks the translation units of build/compile_commands.json. Each merges about a dozen sources, so that the
headers of libraries are read once for all of them. A unit without findings is checked again only if it, a
header of this repository that it includes, its compile command or .clang-tidy changes.
"""

import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import subprocess

from files import CPP, ROOT

# Flags of g++ that clang does not know, or that only set the output.
DROPPED = {"-fno-semantic-interposition", "-MD", "-c"}
DROPPED_PREFIXES = ("-mmove-max=", "-mstore-max=", "-mmemcpy-strategy=")  # only GCC has these
DROPPED_WITH_ARGUMENT = {"-o", "-MT", "-MF"}
INCLUDE = re.compile(rb"^\s*#\s*include\s*\"([^\"]+)\"", re.MULTILINE)
FINDING = re.compile(r"(\S+?):(\d+:\d+: (?:warning|error): .*)")


class Unit:
    """One translation unit: its folder, file and the arguments for clang."""

    def __init__(self, entry):
        self.directory = entry["directory"]
        self.file = pathlib.Path(self.directory, entry["file"])
        self.arguments = []
        words = iter(shlex.split(entry["command"]))
        for word in words:
            if word in DROPPED_WITH_ARGUMENT:
                next(words)
            elif word in DROPPED or word.startswith(DROPPED_PREFIXES):
                continue
            elif word != entry["file"]:
                self.arguments.append(word)
        # Before the first option are the compiler and its launcher.
        while self.arguments and not self.arguments[0].startswith("-"):
            self.arguments.pop(0)

    def sources(self):
        """Returns the sources of this repository in the unit."""
        if self.file.suffix == ".cpp" and ROOT / "src" in self.file.parents:
            return [self.file]
        included = INCLUDE.findall(self.file.read_bytes()) if self.file.is_file() else []
        paths = [pathlib.Path(os.fsdecode(name)) for name in included]
        return [p for p in paths if p.suffix == ".cpp" and ROOT / "src" in p.parents]

    def name(self):
        """Returns a name that is valid for a file: auv_dynamics.unity_0_cxx, or the source with dots."""
        match = re.search(r"CMakeFiles/([^/]+)\.dir/", str(self.file))
        if match:
            return f"{match.group(1)}.{self.file.stem}"
        return ".".join(self.file.relative_to(ROOT / "src").parts)


def wanted_units(build):
    """Returns the units of `build` to check: all except tests and benchmarks."""
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    units = []
    for unit in map(Unit, entries):
        folders = {p.relative_to(ROOT / "src").parts[1] for p in unit.sources()}
        if folders and not folders & {"test", "bench"}:
            units.append(unit)
    return units


class Includes:
    """Finds the files of this repository that a file includes directly or indirectly."""

    def __init__(self):
        self.known = {}
        self.by_name = {}
        for path in (ROOT / "src").rglob("*.hpp"):
            self.by_name.setdefault(path.name, []).append(path)

    def direct(self, path):
        """Returns the files that `path` includes; all candidates if a name is ambiguous."""
        if path not in self.known:
            found = set()
            for name in INCLUDE.findall(path.read_bytes()):
                tail = os.fsdecode(name)
                if tail.startswith("/"):
                    found.add(pathlib.Path(tail))
                    continue
                last = tail.rsplit("/", 1)[-1]
                found.update(p for p in self.by_name.get(last, []) if str(p).endswith(tail))
            self.known[path] = {p for p in found if p.suffix in CPP and p.is_file()}
        return self.known[path]

    def closure(self, path):
        """Returns `path` and all files of this repository that it includes."""
        seen, todo = set(), [path]
        while todo:
            file = todo.pop()
            if file not in seen:
                seen.add(file)
                todo.extend(self.direct(file))
        return seen


def key_of(unit, includes, version):
    """Returns a digest of all our files on which the result for `unit` depends."""
    digest = hashlib.sha256(version.encode())
    digest.update("\0".join(unit.arguments).encode())
    files = {ROOT / ".clang-tidy", *(ROOT / "src" / "auv_msgs").rglob("*.msg")}
    for file in sorted(files | includes.closure(unit.file)):
        digest.update(str(file).encode() + b"\0" + file.read_bytes())
    return digest.hexdigest()


def tidy(unit):
    """Returns the findings in one unit."""
    done = subprocess.run(
        [
            "clang-tidy",
            "--quiet",
            f"--config-file={ROOT / '.clang-tidy'}",
            f"--header-filter={re.escape(str(ROOT / 'src'))}/.*",
            str(unit.file),
            "--",
            *unit.arguments,
            "-Wno-error",
        ],
        cwd=unit.directory,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        universal_newlines=True,
        errors="replace",
        check=False,
    )
    findings = []
    for line in done.stdout.splitlines():
        match = FINDING.match(line)
        if match:
            path = os.path.relpath(os.path.join(unit.directory, match.group(1)), ROOT)
            findings.append(f"{path}:{match.group(2)}")
    if done.returncode and not findings:
        findings = [f"{unit.name()}: {done.stderr.strip() or done.returncode}"]
    return findings


def check_tidy(build):
    """Runs clang-tidy on every unit of `build` that changed since its last check without findings."""
    stamps = build / "lint"
    stamps.mkdir(parents=True, exist_ok=True)
    version = subprocess.run(
        ["clang-tidy", "--version"], stdout=subprocess.PIPE, universal_newlines=True, check=True
    ).stdout
    includes = Includes()
    units = wanted_units(build)
    keys = {unit.name(): key_of(unit, includes, version) for unit in units}

    def is_clean(unit):
        stamp = stamps / unit.name()
        return stamp.is_file() and stamp.read_text() == keys[unit.name()]

    todo = [unit for unit in units if not is_clean(unit)]
    # The largest ones come first, so that no core waits for one of them at the end.
    todo.sort(key=lambda unit: -len(includes.closure(unit.file)))
    findings = []
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for unit, found in zip(todo, pool.map(tidy, todo)):
            findings += found
            if not found:
                (stamps / unit.name()).write_text(keys[unit.name()])
    looked_at = f"{len(units)} units, {len(todo)} changed"
    if not units:
        findings.append("nothing to look at; run ./stg build first")
    return looked_at, sorted(set(findings))
