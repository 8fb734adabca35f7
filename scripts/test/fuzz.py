#!/usr/bin/python3
"""Runs the fuzzers of a built fuzz folder, one target after the other; called by `./stg fuzz`.

Each target starts from its inputs in fuzz/corpus and fuzz/regressions and from what earlier runs
have found new code with, which stays in the build folder. An input that breaks something is kept in
FOLDER/findings, and is printed with the command that repeats it. The last line counts; the exit status is
0 only if nothing was found.
"""

import argparse
import os
import pathlib
import re
import subprocess
import sys

from stg_common.program import run_program

ROOT = pathlib.Path(__file__).resolve().parents[2]
TARGETS = sorted(path.name for path in (ROOT / "fuzz" / "corpus").iterdir())
SECONDS = 60
LONGEST_INPUT = {"packet": 64, "s2c_modem": 1024, "janus_modem": 1024,
                 "micromodem": 1024, "modem_answers": 1024,
                 "recording": 1024, "track": 1024, "motions": 4096,
                 "checkpoint": 65536, "policy": 65536, "bathymetry": 16384}  # fmt: skip
LONGEST_OTHER = 16384
MEMORY_MIB = 2048


def parse(argv):
    """Reads the command line."""
    parser = argparse.ArgumentParser(prog="./stg fuzz", description=__doc__.splitlines()[0])
    parser.add_argument("target", nargs="?", metavar="TARGET",
                        help=f"one of {', '.join(TARGETS)}; default: all")  # fmt: skip
    parser.add_argument("seconds", nargs="?", type=int, default=SECONDS, metavar="SECONDS",
                        help=f"time for each target ({SECONDS})")  # fmt: skip
    parser.add_argument("--runs", type=int, default=0, metavar="N",
                        help="also end a target after N inputs")  # fmt: skip
    parser.add_argument("--build", type=pathlib.Path, required=True,
                        help=argparse.SUPPRESS)  # fmt: skip
    options = parser.parse_args(argv)
    if options.target and options.target not in TARGETS:
        parser.error(f"no target '{options.target}'; there are: {', '.join(TARGETS)}")
    if options.seconds < 1:
        parser.error("SECONDS must be 1 or more")
    if options.runs < 0:
        parser.error("--runs must not be negative")
    return options


def run(target, options):
    """Runs one target; returns (inputs, findings)."""
    program = options.build / "src" / "marl_trainer" / "fuzz" / "stg_fuzz"
    corpus = options.build / "corpus" / target
    findings = options.build / "findings" / target
    for folder in (corpus, findings):
        folder.mkdir(parents=True, exist_ok=True)
    known = set(findings.iterdir())
    folders = [corpus, ROOT / "fuzz" / "corpus" / target, ROOT / "fuzz" / "regressions" / target]
    command = [program, *(folder for folder in folders if folder.is_dir()),
               f"-max_total_time={options.seconds}", f"-artifact_prefix={findings}/",
               f"-max_len={LONGEST_INPUT.get(target, LONGEST_OTHER)}",
               f"-rss_limit_mb={MEMORY_MIB}", "-timeout=10", "-print_final_stats=1",
               "-verbosity=1"]  # fmt: skip
    if options.runs:
        command.append(f"-runs={options.runs}")
    environment = dict(os.environ, STG_FUZZ_TARGET=target, LD_LIBRARY_PATH="",
                       STG_SCENARIOS=str(ROOT / "src" / "stg_bringup" / "scenarios"))  # fmt: skip
    # Inputs are short, and their memory is freed soon.
    environment.setdefault("ASAN_OPTIONS", "quarantine_size_mb=8:malloc_context_size=6")
    log = options.build / "findings" / f"{target}.log"
    with open(log, "wb") as output:
        status = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL,
                                stdout=output, stderr=output, check=False,
                                env=environment).returncode  # fmt: skip
    text = log.read_text(encoding="utf-8", errors="replace")
    counted = re.findall(r"stat::number_of_executed_units: ([0-9]+)", text)
    size = re.findall(r"stat::input_bytes: ([0-9]+)", text)
    found = sorted(set(findings.iterdir()) - known)
    print(f"{target}: {counted[-1] if counted else '?'} inputs, {size[-1] if size else '?'} bytes, "
          f"{len(found)} findings", flush=True)  # fmt: skip
    for path in found:
        print(f"  {path}\n  again: STG_FUZZ_TARGET={target} {program} {path}", flush=True)
    if status != 0 and not found:
        print(f"  ended with status {status}, see {log}", flush=True)
    return int(counted[-1]) if counted else 0, len(found) + (status != 0 and not found)


def main(argv):
    """Runs one target or all; returns the exit status."""
    options = parse(argv)
    results = [run(target, options) for target in ([options.target] if options.target else TARGETS)]
    inputs, findings = (sum(column) for column in zip(*results))
    print(f"{inputs} inputs, {findings} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    run_program("fuzz", lambda: main(sys.argv[1:]))
