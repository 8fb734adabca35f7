#!/usr/bin/python3
"""The checks of `./stg lint`: formatting, static analysis and the rules of the house.

Each checker counts as one test. Findings go to the output as FILE:LINE: TEXT; the last line is
"N passed, M failed", and the exit status is 0 only when nothing failed.
"""

import argparse
import pathlib
import sys
import time
import xml.etree.ElementTree as ElementTree

import house
from tidy import check_tidy
from tools import check_catkin, check_format, check_python, check_shell
from versions import check_versions
from words import check_words

from stg_common.program import run_program

SHOWN = 200  # findings of one checker


def parse(argv, names):
    """Reads the command line."""
    parser = argparse.ArgumentParser(prog="./stg lint", description=__doc__.splitlines()[0])
    parser.add_argument("checkers", nargs="*", metavar="CHECKER", help=", ".join(names))
    parser.add_argument("--fix", action="store_true", help="let clang-format rewrite the sources")
    parser.add_argument("--build", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--junit", help=argparse.SUPPRESS)
    options = parser.parse_args(argv)
    unknown = [name for name in options.checkers if name not in names]
    if unknown:
        parser.error(f"no checker '{unknown[0]}'; there are: {', '.join(names)}")
    if options.fix and options.checkers and "format" not in options.checkers:
        parser.error(f"--fix has no effect on {options.checkers[0]}, because only the checker format repairs files")
    return options


def write_junit(path, results):
    """Writes {checker: findings} as a JUnit file, one case each."""
    suite = ElementTree.Element("testsuite", name="lint", tests=str(len(results)))
    for name, findings in results.items():
        case = ElementTree.SubElement(suite, "testcase", classname="lint", name=name)
        if findings:
            ElementTree.SubElement(case, "failure", message=f"{len(findings)} findings")
    pathlib.Path(path).parent.mkdir(parents=True, exist_ok=True)
    ElementTree.ElementTree(suite).write(path, encoding="utf-8", xml_declaration=True)


def main(argv):
    """Runs the checkers of the command line, or all; returns the exit status."""
    checkers = {
        "format": lambda: check_format(options.fix),
        "shell": check_shell,
        "python": check_python,
        "catkin": check_catkin,
        "includes": house.check_includes,
        "circles": house.check_circles,
        "sizes": house.check_sizes,
        "topics": house.check_topics,
        "namespaces": house.check_namespaces,
        "registries": house.check_registries,
        "scenarios": house.check_scenarios,
        "ranks": house.check_ranks,
        "versions": check_versions,
        "words": check_words,
        "tidy": lambda: check_tidy(options.build),
    }
    options = parse(argv, list(checkers))
    results = {}
    for name in options.checkers or checkers:
        start = time.monotonic()
        looked_at, results[name] = checkers[name]()
        word = "FAIL" if results[name] else "ok"
        seconds = time.monotonic() - start
        print(f"{word:4} lint {name}: {looked_at}, {len(results[name])} findings, {seconds:.1f} s")
        for finding in results[name][:SHOWN]:
            print(f"    {finding}")
        if len(results[name]) > SHOWN:
            print(f"    and {len(results[name]) - SHOWN} more")
        sys.stdout.flush()
    if options.junit:
        write_junit(options.junit, results)
    failed = sum(1 for findings in results.values() if findings)
    print(f"{len(results) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    run_program("lint", lambda: main(sys.argv[1:]))
