"""The cores without catkin and ROS: they compile, and their users get the right flags.

With STG_EACH_ALONE=1 in the environment each source is compiled alone, so it must include what it needs.
This takes ten minutes on two cores; otherwise a dozen sources are compiled together, which takes three.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import roslib.packages

ROOT = pathlib.Path(__file__).resolve().parents[3]
# These headers belong to ROS, wherever ROS is installed.
ROS_HEADER = re.compile(
    r"/(ros|rosbag|diagnostic_updater|tf2\w*|\w+_msgs|std_srvs|message_filters|xmlrpcpp)/[^/]+\.h"
)
CATKIN_USER = """
cmake_minimum_required(VERSION 3.16)
project(user LANGUAGES CXX)
find_package(auv_common REQUIRED)
get_directory_property(options COMPILE_OPTIONS)
message(STATUS "flags: ${options}")
"""


def environment(**changed):
    """Returns the environment without anything that leads to ROS or this workspace, plus `changed`."""
    leads = ("ROS", "CMAKE", "CATKIN", "LD_LIBRARY_PATH", "PYTHONPATH")
    kept = {k: v for k, v in os.environ.items() if not k.startswith(leads)}
    kept["PATH"] = "/usr/bin:/bin"
    kept.update(changed)
    return kept


def run(*command, **changed):
    """Runs a command outside ROS; returns its output, or raises AssertionError with it."""
    done = subprocess.run(
        [str(word) for word in command],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        universal_newlines=True,
        env=environment(**changed),
        check=False,
    )
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}:\n{done.stdout[-6000:]}")
    return done.stdout


def instruction_set(flags):
    """Returns the flags that decide about layout and rounding."""
    return sorted(set(re.findall(r"-march=[\w.-]+|-ffp-contract=\w+|-fno-tree-slp-vectorize", flags)))


class PlainCMake(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.build = cls.folder / "build"
        cls.prefix = cls.folder / "prefix"
        together = "OFF" if os.environ.get("STG_EACH_ALONE") == "1" else "ON"
        run(
            "cmake",
            "-S", ROOT,
            "-B", cls.build,
            "-G", "Ninja",
            "-DCMAKE_BUILD_TYPE=None",
            "-DCMAKE_CXX_FLAGS=-O0",
            "-DCMAKE_DISABLE_FIND_PACKAGE_catkin=ON",
            "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON",
            f"-DCMAKE_INSTALL_PREFIX={cls.prefix}",
            "-DSTG_TESTS=OFF",
            f"-DSTG_UNITY={together}",
            "-DSTG_WERROR=ON",
        )  # fmt: skip

    def test_1_cores_compile_without_catkin_and_ros(self):
        run("ninja", "-C", self.build, "stg_cores", "stg_python", "marl_trainer_check_trace")
        headers = run("ninja", "-C", self.build, "-t", "deps")
        self.assertIn("auv_common/numbers/lanes.hpp", headers)
        self.assertEqual(sorted({m.group(0) for m in ROS_HEADER.finditer(headers)}), [])
        commands = (self.build / "compile_commands.json").read_text(encoding="utf-8")
        self.assertNotIn("catkin", commands)
        self.assertNotIn("/nodes/", commands)

    def test_2_a_user_of_the_installed_libraries_is_compiled_alike(self):
        run("cmake", "--install", self.build)
        # The user's folder is a copy, as if there were no repository.
        user = self.folder / "user"
        shutil.copytree(ROOT / "examples" / "own_project", user)
        run("cmake", "-S", user, "-B", user / "build", "-G", "Ninja",
            f"-DCMAKE_PREFIX_PATH={self.prefix}", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON")  # fmt: skip
        run("cmake", "--build", user / "build")
        printed = run(user / "build" / "spiral").splitlines()
        flown = {line.split()[0]: [float(x) for x in line.split()[1:]] for line in printed}
        self.assertEqual(set(flown), {"spiral:speed=0.3", "pursuit_separated"})
        # Also in a sourced workspace, the program and the module load the installed libraries.
        (module,) = self.prefix.rglob("stg/_core.*.so")
        (ours,) = {os.path.dirname(path) for path in self.prefix.rglob("libstg_env.so")}
        for program in (user / "build" / "spiral", module):
            told = run("ldd", program, LD_LIBRARY_PATH=os.environ["LD_LIBRARY_PATH"])
            loaded = re.findall(r"(?:lib(?:auv|acoustic|stg|marl)_\w+\.so\S*) => (\S+)", told)
            self.assertGreaterEqual(len(loaded), 5, told)
            self.assertEqual({os.path.dirname(os.path.realpath(x)) for x in loaded},
                             {os.path.realpath(ours)}, told)  # fmt: skip
        # If packs had another layout here than in the libraries, the flights would differ.
        (evaluate,) = roslib.packages.find_node("marl_trainer", "evaluate")
        told = run(evaluate, "--policy", "pursuit_separated", "--episodes", "4",
                   STG_SCENARIOS=str(ROOT / "src" / "stg_bringup" / "scenarios"))  # fmt: skip
        numbers = json.loads(told.splitlines()[-1])
        self.assertEqual(flown["pursuit_separated"], [numbers["return"], numbers["tail_distance"]])
        self.assertGreater(flown["spiral:speed=0.3"][0], 0.0)
        told = run(evaluate, "--plugin", user / "build" / "libspiral.so", "--policy",
                   "spiral:speed=0.3", "--episodes", "4",
                   STG_SCENARIOS=str(ROOT / "src" / "stg_bringup" / "scenarios"))  # fmt: skip
        numbers = json.loads(told.splitlines()[-1])
        self.assertEqual(flown["spiral:speed=0.3"], [numbers["return"], numbers["tail_distance"]])
        commands = []
        for build in (self.build, user / "build"):
            entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
            commands.append({tuple(instruction_set(entry["command"])) for entry in entries})
        self.assertEqual(commands[0], commands[1])
        self.assertIn("-ffp-contract=off", commands[1].pop())

    def test_3_the_python_module_flies_where_it_was_built_and_installed(self):
        program = "import stg; e = stg.parallel_env('hard'); e.reset(); e.step({a: e.action_space(a).sample() for a in e.agents})"
        for folder in (self.build / "python", next(self.prefix.rglob("dist-packages"))):
            run("/usr/bin/python3", "-c", program, PYTHONPATH=str(folder), PYTHONDONTWRITEBYTECODE="1")
        (module,) = self.build.glob("python/stg/_core.*.so")
        self.assertNotIn("torch", run("ldd", module))

    def test_4_a_user_with_catkin_is_compiled_alike(self):
        prefixes = os.environ.get("CMAKE_PREFIX_PATH", "").split(":")
        workspace = [p for p in prefixes if os.path.isdir(f"{p}/share/auv_common/cmake")]
        self.assertTrue(workspace, "this test runs in a sourced workspace")
        user = self.folder / "catkin_user"
        user.mkdir()
        (user / "CMakeLists.txt").write_text(CATKIN_USER, encoding="utf-8")
        output = run("cmake", "-S", user, "-B", user / "build",
                     CMAKE_PREFIX_PATH=os.environ["CMAKE_PREFIX_PATH"])  # fmt: skip
        flags = re.search(r"flags: (.*)", output).group(1)
        entries = json.loads((self.build / "compile_commands.json").read_text(encoding="utf-8"))
        self.assertEqual(instruction_set(flags), instruction_set(entries[0]["command"]))
        self.assertIn("-ffp-contract=off", flags)


if __name__ == "__main__":
    unittest.main()
