#!/usr/bin/python3
"""Puts the module stg into a wheel: its files, engines, scenarios, policies and foreign libraries.

An engine is a built stg/_core.*.so, as INSTRUCTION_SET=FILE: `baseline` lies in the package, others
in folders that stg chooses from by the processor. Shared libraries that not every Linux has come with
it and are found by a path relative to the engine.
"""

import argparse
import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAME = "stg_swarm"
TAG = "cp311-cp311-manylinux_2_36_x86_64"
# Libraries that a Python wheel for Linux may expect on every system (PEP 600).
EVERYWHERE = re.compile(r"(ld-linux-x86-64|libc|libm|libdl|libpthread|librt|libstdc\+\+|libgcc_s|libz)\.so")
# Libraries of this repository. They have the engine's instruction set and are in its folder, where scenarios
# are searched first.
OURS = re.compile(r"lib(acoustic|auv|stg)_")
METADATA = """Metadata-Version: 2.1
Name: stg-swarm
Version: {version}
Summary: Swarms of AUVs that track targets under acoustic communication, for multi-agent learning
License: BSD-3-Clause
Requires-Python: >=3.11,<3.12
Requires-Dist: numpy>=1.24,<2
Provides-Extra: pictures
Requires-Dist: matplotlib>=3.6; extra == "pictures"
Provides-Extra: learning
Requires-Dist: gymnasium>=1.0; extra == "learning"
Requires-Dist: pettingzoo>=1.24; extra == "learning"
Description-Content-Type: text/markdown

"""
WHEEL = """Wheel-Version: 1.0
Generator: scripts/package/make_wheel.py
Root-Is-Purelib: false
Tag: {tag}
"""


def run(*command):
    """Returns the output of a command. Raises SystemExit with its errors if it fails."""
    done = subprocess.run(
        [str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        universal_newlines=True, check=False,
    )  # fmt: skip
    if done.returncode != 0:
        raise SystemExit(f"make_wheel: {command[0]}: {done.stderr.strip()}")
    return done.stdout


def libraries_of(engine):
    """Returns {name: path} of the libraries that the wheel must contain for an engine."""
    found = {}
    for line in run("ldd", engine).splitlines():
        match = re.match(r"\s*(\S+) => (.*?)(?: \(0x|$)", line)
        if not match or EVERYWHERE.match(match.group(1)):
            continue
        if not match.group(2).startswith("/"):
            raise SystemExit(f"make_wheel: {engine}: {match.group(1)} is not found")
        found[match.group(1)] = pathlib.Path(match.group(2)).resolve()
    return found


def place(source, target, rpath):
    """Copies a shared object without symbols. It will search for others below `rpath`."""
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(source, target)
    run("strip", "--strip-unneeded", target)
    run("patchelf", "--force-rpath", "--set-rpath", rpath, target)
    target.chmod(0o755)


def gather(folder, engines):
    """Fills `folder` with the content of the wheel."""
    package = folder / "stg"
    shutil.copytree(
        ROOT / "src/stg_python/python/stg", package, ignore=shutil.ignore_patterns("__pycache__")
    )
    shutil.copytree(
        ROOT / "src/stg_python/examples", package / "examples",
        ignore=shutil.ignore_patterns("__pycache__", "agent.py"),
    )  # fmt: skip
    share = package / "share" / "stg_bringup"
    for data in ("scenarios", "policies", "terrain"):
        shutil.copytree(ROOT / "src/stg_bringup" / data, share / data)
    shutil.copy(ROOT / "LICENSE", package / "share" / "LICENSE")
    for name, engine in engines.items():
        own = package if name == "baseline" else package / f"_{name.replace('-', '_')}"
        rpath = f"$ORIGIN:$ORIGIN/{'../' * len(own.relative_to(folder).parts)}{NAME}.libs"
        place(engine, own / engine.name, rpath)
        if name == "baseline":
            # A module beside the engine asks the processor which engine it supports. This engine runs on
            # every processor.
            askers = list(engine.parent.glob("_processor.*.so"))
            if not askers and len(engines) > 1:
                raise SystemExit(f"make_wheel: {engine.parent} holds no _processor.*.so, which chooses among engines")
            for asker in askers:
                place(asker, own / asker.name, rpath)
        for library, path in libraries_of(engine).items():
            if OURS.match(library):
                place(path, own / library, rpath)
            else:
                place(path, folder / f"{NAME}.libs" / library, "$ORIGIN")


def write(folder, out, version):
    """Packs `folder` into the wheel and returns its path. The same files give the same bytes."""
    info = folder / f"{NAME}-{version}.dist-info"
    info.mkdir()
    readme = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    (info / "METADATA").write_text(METADATA.format(version=version) + readme, encoding="utf-8")
    (info / "WHEEL").write_text(WHEEL.format(tag=TAG))
    out.mkdir(parents=True, exist_ok=True)
    wheel = out / f"{NAME}-{version}-{TAG}.whl"
    record = []
    with zipfile.ZipFile(wheel.with_suffix(".tmp"), "w", zipfile.ZIP_DEFLATED) as archive:

        def add(name, data, mode):
            entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
            entry.external_attr = (0o100000 | mode) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)

        for path in sorted(p for p in folder.rglob("*") if p.is_file()):
            name, data = str(path.relative_to(folder)), path.read_bytes()
            add(name, data, 0o755 if os.access(path, os.X_OK) else 0o644)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{name},sha256={digest},{len(data)}")
        record.append(f"{info.name}/RECORD,,")
        add(f"{info.name}/RECORD", "\n".join(record) + "\n", 0o644)
    wheel.with_suffix(".tmp").replace(wheel)
    return wheel


def main(argv):
    """Makes the wheel and prints its name."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engines", nargs="+", metavar="INSTRUCTION_SET=FILE")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "dist", help="folder (default: dist)")
    options = parser.parse_args(argv)
    engines = {}
    for text in options.engines:
        name, _, file = text.partition("=")
        if not re.fullmatch(r"[\w-]+", name) or not pathlib.Path(file).is_file():
            parser.error(f"'{text}' is not of the form INSTRUCTION_SET=FILE")
        engines[name] = pathlib.Path(file)
    if "baseline" not in engines:
        parser.error("an engine of the instruction set baseline is needed")
    version = (ROOT / "VERSION").read_text(encoding="utf-8").strip()
    with tempfile.TemporaryDirectory() as folder:
        gather(pathlib.Path(folder), engines)
        print(write(pathlib.Path(folder), options.out, version))


if __name__ == "__main__":
    main(sys.argv[1:])
