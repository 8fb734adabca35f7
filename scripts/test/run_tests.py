#!/usr/bin/python3
"""Runs every test of a built catkin workspace, one after the other, and counts the results.

The tests are those that catkin registered with CTest: GoogleTests, Python tests and rostests. Each
writes a JUnit file, and each case in it counts. A test that leaves no readable file, has no case,
or exits with an error without reporting one, counts as one failure: a crash is never silent. The
last line of the output is "N passed, M failed"; the exit status is 0 only if something ran and
nothing failed.
"""

import argparse
import difflib
import glob
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree

from stg_common.program import run_program

TIMEOUT_S = float(os.environ.get("STG_TEST_TIMEOUT_S", "1800"))
SHOWN_LINES = 80


class Test:
    """One program to run: its name, command and result file, and other names for it."""

    def __init__(self, name, command, result_file, labels=()):
        self.name = name
        self.command = command
        self.result_file = result_file
        self.labels = labels

    def matches(self, pattern):
        """True if the name, or the name of a source file, contains `pattern`."""
        return any(pattern in name for name in (self.name, *self.labels))


def registered_tests(build_dir):
    """Returns the tests that CTest knows in `build_dir`."""
    listing = subprocess.run(
        ["ctest", "--show-only=json-v1"], cwd=build_dir, check=True, stdout=subprocess.PIPE
    ).stdout
    tests = []
    for test in json.loads(listing)["tests"]:
        command = test.get("command", [])
        results = [a for a in command if a.endswith(".xml") and "test_results" in a]
        result = results[0].replace("--gtest_output=xml:", "") if results else os.devnull + ".xml"
        labels = [p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"]
        name = test["name"].replace("_ctest_", "", 1)
        tests.append(Test(name, command, result, labels[0] if labels else ()))
    return tests


def lint_test(build_dir):
    """Returns the checks of `./stg lint` as a test."""
    lint = str(pathlib.Path(__file__).resolve().parents[1] / "lint")
    result_file = os.path.join(build_dir, "test_results", "lint.xml")
    command = [sys.executable, lint, "--build", build_dir, "--junit", result_file]
    return Test("lint", command, result_file)


def session_members(session):
    """Returns the ids of the processes in `session`; this finds the nodes of a rostest."""
    members = []
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            try:
                with open(f"/proc/{entry}/stat", encoding="utf-8", errors="replace") as stat:
                    fields = stat.read().rpartition(")")[2].split()
            except OSError:
                continue
            if int(fields[3]) == session and fields[0] != "Z":
                members.append(int(entry))
    return members


def end_session(session):
    """Interrupts the remaining processes of a test, and kills those that still run after ten seconds."""
    for number, patience_s in ((signal.SIGINT, 10.0), (signal.SIGKILL, 2.0)):
        deadline = time.monotonic() + patience_s
        for process in session_members(session):
            try:
                os.kill(process, number)
            except ProcessLookupError:
                pass
        while session_members(session) and time.monotonic() < deadline:
            time.sleep(0.1)


def with_modules(command):
    """Returns the command of a test with the folders of its Python files in PYTHONPATH. catkin's `nosetests -P`
    does not add them, and catkin's script at the start of the command may replace PYTHONPATH."""
    if not command[0].endswith("env_cached.sh"):
        return command
    folders = {os.path.dirname(file) for file in re.findall(r"/\S+\.py(?= )", " ".join(command[4:]))}
    path = os.pathsep.join([*sorted(folders), os.environ.get("PYTHONPATH", "")])
    return [command[0], "/usr/bin/env", f"PYTHONPATH={path}", *command[1:]]


def execute(command, log_path):
    """Runs `command` in its own session. Returns its exit status, or None beyond the time limit."""
    with open(log_path, "wb") as log:
        process = subprocess.Popen(
            with_modules(command), stdin=subprocess.DEVNULL, stdout=log, stderr=log,
            start_new_session=True,
        )  # fmt: skip
        try:
            return process.wait(TIMEOUT_S)
        except subprocess.TimeoutExpired:
            return None
        finally:
            end_session(process.pid)
            process.wait()


def count_cases(path):
    """Returns (passed, failures) of a JUnit file; `failures` names each failed case."""
    passed, failures = 0, []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        name = f"{case.get('classname', '')}.{case.get('name', '')}"
        if case.find("failure") is not None or case.find("error") is not None:
            failures.append(name)
        elif case.find("skipped") is None and case.get("status", "run") == "run":
            passed += 1
    return passed, failures


def skips(path):
    """True if a JUnit file has a skipped case, which explains why nothing ran."""
    return any(case.find("skipped") is not None for case in ElementTree.parse(path).iter("testcase"))


def inner_results(result_file):
    """Returns the files with the cases of each test node, if `result_file` is of a rostest.

    The rostest's own file only says if each node left results, and does not contain them.
    """
    if not os.path.basename(result_file).startswith("rostest-"):
        return []
    return glob.glob(os.path.join(os.path.dirname(result_file), "rosunit-*.xml"))


def remove_results(result_file):
    """Removes the results of an earlier run of a test, so that they are not counted again."""
    for path in [result_file] + inner_results(result_file):
        if os.path.exists(path):
            os.remove(path)


def judge(status, result_file):
    """Returns (passed, failures) of one finished test."""
    try:
        passed, failures = count_cases(result_file)
        inner = [count_cases(path) for path in inner_results(result_file)]
        if inner:
            passed = sum(count for count, _ in inner)
            failures += [name for _, names in inner for name in names]
    except (OSError, ElementTree.ParseError):
        passed, failures = 0, [] if status is None else ["no readable result file"]
    if status is None:
        failures.append(f"still running after {TIMEOUT_S:.0f} s")
    elif status != 0 and not failures:
        failures.append(f"exit status {status}")
    elif passed == 0 and not failures and not skips(result_file):
        failures.append("ran no case")
    return passed, failures


def show_log(log_path):
    """Prints the end of a failed test's output."""
    with open(log_path, encoding="utf-8", errors="replace") as log:
        for line in log.read().splitlines()[-SHOWN_LINES:]:
            print(f"    | {line}")


def parse(argv):
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build_dir", type=os.path.abspath, help="the build folder")
    parser.add_argument("pattern", nargs="?", default="", help="part of a test's name (all)")
    parser.add_argument("--lint", action="store_true", help="count the checks of lint as well")
    return parser.parse_args(argv)


def main(argv):
    """Runs the tests of the command line; returns the exit status."""
    options = parse(argv)
    build_dir = options.build_dir
    log_dir = os.path.join(build_dir, "test_logs")
    os.makedirs(log_dir, exist_ok=True)
    os.environ.setdefault("ROS_HOME", os.path.join(build_dir, "ros_home"))
    tests = [lint_test(build_dir)] if options.lint else []
    tests += registered_tests(build_dir)
    total_passed, total_failed = 0, 0
    wanted = [test for test in tests if test.matches(options.pattern)]
    if not wanted:
        near = difflib.get_close_matches(options.pattern, [test.name for test in tests], 3, 0.3)
        print(f"no test has '{options.pattern}' in its name, nor in that of a source file"
              + (f"; the nearest are {', '.join(near)}" if near else ""))
    for test in wanted:
        remove_results(test.result_file)
        log_path = os.path.join(log_dir, f"{test.name}.log")
        start = time.monotonic()
        status = execute(test.command, log_path)
        passed, failures = judge(status, test.result_file)
        seconds = time.monotonic() - start
        word = "FAIL" if failures else "ok"
        print(f"{word:4} {test.name}: {passed} passed, {len(failures)} failed, {seconds:.1f} s")
        if failures:
            for failure in failures:
                print(f"    failed: {failure}")
            show_log(log_path)
        sys.stdout.flush()
        total_passed += passed
        total_failed += len(failures)
    print(f"{total_passed} passed, {total_failed} failed")
    return 0 if total_passed > 0 and total_failed == 0 else 1


if __name__ == "__main__":
    run_program("test", lambda: main(sys.argv[1:]))
