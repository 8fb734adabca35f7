"""The Debian packages: what they name exists, and their launcher starts the right program."""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
DEBIAN = ROOT / "debian"
# Parts of debhelper. packages.txt names the packages that provide them.
HELPERS = {"debhelper-compat": "debhelper", "dh-sequence-python3": "dh-python"}
PROGRAM = "#!/bin/sh\necho {name} \"$@\"\nexit 3\n"


def paragraphs():
    """Returns the paragraphs of debian/control, each as {field: text}."""
    text = (DEBIAN / "control").read_text(encoding="utf-8")
    return [
        dict(re.findall(r"^([\w-]+):((?:.*\n)(?:[ \t].*\n)*)", part + "\n", re.MULTILINE))
        for part in text.strip().split("\n\n")
    ]


def names(field):
    """Returns the set of package names in a field of dependencies."""
    return {word.split()[0] for word in field.split(",") if word.split()}


class Control(unittest.TestCase):
    def test_a_clone_that_is_set_up_can_build_them(self):
        installed = set(re.findall(r"^[a-z]\S*", (ROOT / "packages.txt").read_text(), re.MULTILINE))
        needed = {HELPERS.get(name, name) for name in names(paragraphs()[0]["Build-Depends"])}
        self.assertGreater(len(needed), 20)
        self.assertEqual(needed - installed, set())

    def test_every_library_of_a_node_is_in_one(self):
        listed = "\n".join(path.read_text() for path in DEBIAN.glob("*.install"))
        for path in (ROOT / "src").glob("*/CMakeLists.txt"):
            text = re.sub(r"#.*", "", path.read_text(encoding="utf-8"))
            text = text.replace("${PROJECT_NAME}", path.parent.name)
            installed = set(" ".join(re.findall(r"install\(TARGETS([^()]*?)\b[A-Z]+ DESTINATION", text)).split())
            for library in installed & set(re.findall(r"add_library\((\w+)(?!\s+MODULE)\b", text)):
                self.assertRegex(listed, rf"lib(\*|{library})\.so\.\*", path)

    def test_no_package_links_another_ones_target_by_name(self):
        # debhelper builds each ROS package alone. Targets of other packages are then files, which
        # catkin_LIBRARIES names.
        # catkin_LIBRARIES names.
        texts = {
            path.parent.name: re.sub(r"#.*", "", path.read_text(encoding="utf-8")).replace(
                "${PROJECT_NAME}", path.parent.name
            )
            for path in (ROOT / "src").glob("*/CMakeLists.txt")
        }
        made = {name: set(re.findall(r"add_library\((\w+)", text)) for name, text in texts.items()}
        calls = re.compile(r"(?:target_link_libraries|stg_\w+)\(([^()]*)\)")
        for package, text in texts.items():
            linked = set(" ".join(calls.findall(text)).split())
            others = set().union(*(made[name] for name in made if name != package)) - set(made)
            self.assertEqual(linked & others, set(), package)

    def test_every_ros_package_is_in_one(self):
        listed = "\n".join(path.read_text() for path in DEBIAN.glob("*.install")).split()
        for manifest in ROOT.glob("src/*/package.xml"):
            name = manifest.parent.name
            self.assertEqual(listed.count(f"usr/share/{name}/package.xml"), 1, name)

    def test_dependencies_inside_name_packages(self):
        made = {part["Package"].strip() for part in paragraphs()[1:]}
        lists = {path.stem for path in DEBIAN.glob("*.install")}
        self.assertEqual(lists, made - {"stg-swarm"})
        for part in paragraphs()[1:]:
            ours = {n for n in names(part["Depends"]) if re.match(r"(python3-)?stg\b", n)}
            self.assertEqual(ours - made, set(), part["Package"])


class Launcher(unittest.TestCase):
    """debian/launcher.c, compiled for a folder of the test."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.program = self.folder / "lib" / "marl_trainer" / "train"
        self.program.parent.mkdir(parents=True)
        subprocess.run(
            ["cc", "-Wall", "-Werror", f'-DPRIVATE="{self.folder}"', "-o", self.program,
             DEBIAN / "launcher.c"], check=True,
        )  # fmt: skip
        for name in ("baseline", "x86-64-v3"):
            file = self.folder / name / "marl_trainer" / "train"
            file.parent.mkdir(parents=True)
            file.write_text(PROGRAM.format(name=name))
            file.chmod(0o755)
        # This is what glibc finds in the processor. /proc/cpuinfo may lack a feature that is there.
        told = subprocess.run(
            ["/lib64/ld-linux-x86-64.so.2", "--help"], check=True, stdout=subprocess.PIPE, universal_newlines=True
        ).stdout
        self.best = "x86-64-v3" if "x86-64-v3 (supported" in told else "baseline"

    def fly(self, wanted=None, program=None):
        """Returns exit status and output."""
        env = {k: v for k, v in os.environ.items() if k != "STG_INSTRUCTION_SET"}
        if wanted is not None:
            env["STG_INSTRUCTION_SET"] = wanted
        done = subprocess.run(
            [program or self.program, "--a", "b c"], env=env, check=False, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, universal_newlines=True,
        )  # fmt: skip
        return done.returncode, done.stdout.strip()

    def test_it_starts_the_one_for_this_processor(self):
        self.assertEqual(self.fly(), (3, f"{self.best} --a b c"))
        self.assertEqual(self.fly(""), (3, f"{self.best} --a b c"))
        self.assertEqual(self.fly("baseline"), (3, "baseline --a b c"))

    def test_a_link_to_it_starts_the_same(self):
        link = self.folder / "anything"
        link.symlink_to(self.program)
        self.assertEqual(self.fly("baseline", link), (3, "baseline --a b c"))

    def test_it_does_without_the_better_one(self):
        shutil.rmtree(self.folder / "x86-64-v3")
        self.assertEqual(self.fly(), (3, "baseline --a b c"))

    def test_a_wrong_name_is_refused(self):
        for wanted in ("x86-64-v9", "../x"):
            status, told = self.fly(wanted)
            self.assertEqual(status, 2)
            self.assertIn("STG_INSTRUCTION_SET", told)

    def test_a_program_that_is_gone_is_named(self):
        shutil.rmtree(self.folder / "baseline")
        status, told = self.fly("baseline")
        self.assertEqual(status, 126)
        self.assertIn("baseline/marl_trainer/train", told)


if __name__ == "__main__":
    unittest.main()
