"""The release: one version, and a wheel that flies alone."""

import base64
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

import stg
from stg_common.loading import load_program

ROOT = pathlib.Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "scripts" / "package"
versions = load_program(ROOT / "scripts" / "lint" / "versions.py")

FLY = """
import pathlib, stg
here = pathlib.Path(stg.__file__).parent
assert here.is_relative_to({wheel!r}), here
assert pathlib.Path(stg.scenario_folder()).is_relative_to(here), stg.scenario_folder()
env = stg.parallel_env("medium", seed=4)
env.reset()
for _ in range(20):
    env.step(env.controller_actions(stg.policy_file("medium")))
stg.parallel_env("field20").reset()
print(env.state().tobytes().hex())
"""


def run(*command, **changed):
    """Runs a command without anything that leads to the workspace; returns (status, output)."""
    leads = ("ROS", "CMAKE", "CATKIN", "LD_LIBRARY_PATH", "PYTHON", "STG")
    kept = {k: v for k, v in os.environ.items() if not k.startswith(leads)}
    done = subprocess.run(
        [str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        universal_newlines=True, check=False, env={**kept, **changed},
    )  # fmt: skip
    return done.returncode, done.stdout


class Version(unittest.TestCase):
    def test_the_module_states_it(self):
        self.assertEqual(stg.__version__, (ROOT / "VERSION").read_text().strip())

    def test_every_file_that_states_another_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = pathlib.Path(folder)
            stating = [path.relative_to(ROOT) for path in versions.stated(ROOT)]
            self.assertGreaterEqual(len(stating), 12)
            for path in [pathlib.Path("VERSION"), *stating]:
                (copy / path).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / path, copy / path)
            self.assertEqual(versions.check_versions(copy)[1], [])
            (copy / "VERSION").write_text("9.9.9\n")
            self.assertEqual(len(versions.check_versions(copy)[1]), len(stating))


class Wheel(unittest.TestCase):
    """A wheel of this workspace's engine, for every processor that the workspace supports."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        engine = pathlib.Path(stg._core.__file__)
        status, stated = run(sys.executable, PACKAGE / "make_wheel.py", f"baseline={engine}",
                           "--out", cls.folder / "dist")  # fmt: skip
        assert status == 0, stated
        cls.wheel = pathlib.Path(stated.strip())
        with zipfile.ZipFile(cls.wheel) as archive:
            archive.extractall(cls.folder / "site")

    def test_it_flies_alone_and_alike(self):
        site = self.folder / "site"
        status, stated = run(sys.executable, "-c", FLY.format(wheel=str(site)), PYTHONPATH=str(site),
                           PYTHONDONTWRITEBYTECODE="1")  # fmt: skip
        self.assertEqual(status, 0, stated)
        env = stg.parallel_env("medium", seed=4)
        env.reset()
        for _ in range(20):
            env.step(env.controller_actions(stg.policy_file("medium")))
        self.assertEqual(stated.strip(), env.state().tobytes().hex())

    def test_it_brings_every_library_that_not_everybody_has(self):
        site = self.folder / "site"
        (engine,) = site.glob("stg/_core.*.so")
        status, stated = run("ldd", engine)
        self.assertEqual(status, 0, stated)
        ours = [line for line in stated.splitlines() if "stg_swarm.libs" in line]
        self.assertTrue(any("libprotobuf" in line for line in ours), stated)
        self.assertNotIn(f"=> {ROOT}/", stated)
        self.assertNotIn("not found", stated)

    def test_its_record_is_true(self):
        site = self.folder / "site"
        (record,) = site.glob("*.dist-info/RECORD")
        rows = [line.rsplit(",", 2) for line in record.read_text().splitlines()]
        files = {str(p.relative_to(site)) for p in site.rglob("*") if p.is_file()}
        self.assertEqual({name for name, _, _ in rows}, files)
        for name, digest, size in rows:
            if name.endswith("RECORD"):
                continue
            data = (site / name).read_bytes()
            stated = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            self.assertEqual((digest, int(size)), (f"sha256={stated}", len(data)), name)

    def test_an_instruction_set_that_it_lacks_is_refused(self):
        site = self.folder / "site"
        for wanted in ("x86-64-v9", "../x"):
            status, stated = run(sys.executable, "-c", "import stg", PYTHONPATH=str(site),
                               STG_INSTRUCTION_SET=wanted, PYTHONDONTWRITEBYTECODE="1")  # fmt: skip
            self.assertEqual(status, 1)
            self.assertIn("STG_INSTRUCTION_SET", stated)


if __name__ == "__main__":
    unittest.main()
