"""Checks the bag report with whole and damaged bags, whose contents follow from closed forms."""

import contextlib
import csv
import io
import pathlib
import random
import subprocess
import tempfile
import unittest

import rosbag
import synthetic_bag
from stg_common.loading import load_program

HERE = pathlib.Path(__file__).resolve().parent
SCRIPTS = HERE.parents[1] / "stg_monitor" / "scripts"
bag_report = load_program(SCRIPTS / "bag_report.py")
make_meshes = load_program(HERE.parent / "scripts" / "make_meshes.py")


def run_report(*arguments):
    """Runs the tool in this process; returns (exit status, standard output, standard error)."""
    output, errors = io.StringIO(), io.StringIO()
    rosbag.bag._message_types.clear()  # definitions are kept by md5; a process of its own has none
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        try:
            status = bag_report.main([str(argument) for argument in arguments])
        except SystemExit as leave:
            status = leave.code
    return status, output.getvalue(), errors.getvalue()


def read_table(folder, name):
    """Returns the rows of a CSV file as dictionaries."""
    with open(folder / f"{name}.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class WithFolder(unittest.TestCase):
    """A test with its own folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.bag = self.folder / "run.bag"
        self.out = self.folder / "out"


class Scenario(unittest.TestCase):
    """The scenario that is recorded with the run."""

    def test_one_that_is_none_is_left_out(self):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            for text in ("a: [", "[" * 9999, "a: 2026-99-99", "3", "reward: [1]",
                         "reward: {band_m: near}", "a: 1\na: 2"):  # fmt: skip
                self.assertEqual(bag_report.read_scenario(text), {}, text)
        lines = said.getvalue().splitlines()
        self.assertEqual(len(lines), 7)
        for line in lines:
            self.assertRegex(line, "^bag_report: /scenario:.*; it is ignored$")
        whole = {"name": "medium", "reward": {"band_m": [0.01, 0.015]}}
        self.assertEqual(bag_report.read_scenario(str(whole)), whole)


class WholeBag(WithFolder):
    """A bag that was closed properly."""

    def test_tables_hold_what_was_recorded(self):
        synthetic_bag.write(str(self.bag), 5.0)
        status, _, errors = run_report(self.bag, "-o", self.out, "--no-figures")
        self.assertEqual((status, errors), (0, ""))
        poses = read_table(self.out, "poses")
        self.assertEqual(len(poses), 50 * synthetic_bag.AGENTS)
        for row in poses:
            t = float(row["t_s"]) - 1.0
            expected = synthetic_bag.auv_at(int(row["auv"]), t)
            for name, value in zip("xyz", expected):
                self.assertAlmostEqual(float(row[name + "_m"]), value, delta=1e-12)
            self.assertAlmostEqual(
                float(row["distance_m"]), synthetic_bag.distance_at(t), delta=1e-12
            )
        tasks = read_table(self.out, "tasks")
        self.assertEqual({row["phase"] for row in tasks}, {"search", "approach"})
        self.assertEqual({row["auv"] for row in tasks if row["role"] == "1"}, {"0"})
        links = read_table(self.out, "links")
        pairs = synthetic_bag.AGENTS * (synthetic_bag.AGENTS - 1)
        self.assertEqual(len(links), 50 * pairs)
        self.assertIn("loss", {row["last_drop_reason"] for row in links})
        self.assertEqual(len(read_table(self.out, "steps")), 50)
        (episode,) = read_table(self.out, "episodes")
        self.assertEqual(float(episode["episode_return"]), 100.0)
        self.assertEqual(float(episode["spread"]), 0.75)

    def test_figure_is_written_in_both_formats(self):
        synthetic_bag.write(str(self.bag), 3.0)
        status, _, errors = run_report(self.bag, "-o", self.out)
        self.assertEqual((status, errors), (0, ""))
        png = (self.out / "report_episode_0.png").read_bytes()
        self.assertTrue(png.startswith(b"\x89PNG"))
        self.assertGreater(len(png), 20000)
        self.assertIn("<svg", (self.out / "report_episode_0.svg").read_text())

    def test_an_episode_that_is_not_there_is_refused(self):
        synthetic_bag.write(str(self.bag), 1.0)
        status, _, errors = run_report(self.bag, "-o", self.out, "--episode", 7)
        self.assertEqual(status, 2)
        self.assertIn("no episode 7", errors)
        self.assertFalse(self.out.exists())

    def test_fewer_figures_than_none_are_refused(self):
        with contextlib.redirect_stderr(io.StringIO()), self.assertRaises(SystemExit) as ended:
            bag_report.parse_arguments(["run.bag", "--max-figures", "-1"])
        self.assertEqual(ended.exception.code, 2)


    def test_options_that_draw_nothing_are_refused(self):
        for options, why in (
            (["--no-figures", "--episode", "0"], "--episode has no effect with --no-figures"),
            (["--max-figures", "10", "--no-figures"], "--max-figures has no effect with --no-figures"),
            (["--episode", "0", "--max-figures", "1"], "--max-figures has no effect with --episode"),
        ):
            status, _, errors = run_report(self.bag, *options)
            self.assertEqual(status, 2)
            self.assertIn(why, errors)


class DamagedBag(WithFolder):
    """A file that is no whole bag gives one clear line and nothing else."""

    def refused(self, *options):
        """Runs the tool on the bag. It must refuse the bag in one line that names it."""
        status, output, errors = run_report(self.bag, "-o", self.out, *options)
        self.assertEqual(status, 2)
        self.assertEqual(output, "")
        self.assertEqual(len(errors.splitlines()), 1, errors)
        self.assertIn(str(self.bag), errors)
        self.assertFalse(self.out.exists(), "something was written all the same")
        return errors

    def truncate(self, share):
        """Writes a bag and keeps only `share` of its length."""
        synthetic_bag.write(str(self.bag), 4.0)
        content = self.bag.read_bytes()
        self.bag.write_bytes(content[: int(share * len(content))])

    def test_truncated_bag_is_reported_wherever_it_was_cut(self):
        for share in (0.0001, 0.1, 0.5, 0.9, 0.999):
            with self.subTest(share):
                self.truncate(share)
                self.refused()

    def test_truncated_bag_tells_about_salvage_and_salvage_reads_its_start(self):
        self.truncate(0.6)
        before = self.bag.read_bytes()
        self.assertIn("--salvage", self.refused())
        status, _, _ = run_report(self.bag, "-o", self.out, "--no-figures", "--salvage")
        self.assertEqual(status, 0)
        self.assertEqual(self.bag.read_bytes(), before, "the bag itself was changed")
        poses = read_table(self.out, "poses")
        self.assertGreater(len(poses), 40)
        self.assertLess(len(poses), 40 * synthetic_bag.AGENTS)
        for row in poses:
            expected = synthetic_bag.auv_at(int(row["auv"]), float(row["t_s"]) - 1.0)
            self.assertAlmostEqual(float(row["x_m"]), expected[0], delta=1e-12)

    def test_overwritten_middle_is_reported(self):
        synthetic_bag.write(str(self.bag), 4.0)
        content = bytearray(self.bag.read_bytes())
        middle = len(content) // 2
        content[middle : middle + 4000] = b"\xff" * 4000
        self.bag.write_bytes(bytes(content))
        self.refused()

    def test_damaged_message_definition_is_reported(self):
        synthetic_bag.write(str(self.bag), 1.0)
        whole = self.bag.read_bytes()
        for good, bad in (
            (b"float64 confidence", b"float64 confidencf"),
            (b"float64 confidence", b"float6\x00 confidence"),
            (b"float64 confidence", b"string  confidence"),
            (b"geometry_msgs/PoseWithCovariance", b"geometry_msgs/PoseWithCovarianc\xff"),
            (b"uint32 episode", b"uint32[]episode"),
        ):
            with self.subTest(bad):
                self.assertIn(good, whole)
                self.bag.write_bytes(whole.replace(good, bad))
                self.refused("--no-figures")

    def test_messages_of_another_type_are_reported(self):
        import std_msgs.msg

        for topic in ("/auv_0/odom", "/auv_0/task_state", "/step_report", "/episode_summary"):
            with self.subTest(topic):
                with rosbag.Bag(str(self.bag), "w") as bag:
                    bag.write(topic, std_msgs.msg.String("hello"))
                self.refused()

    def test_whatever_is_damaged_is_told_in_lines(self):
        # These are the first of 340 bags of this kind, and none of these ended otherwise.
        synthetic_bag.write(str(self.bag), 1.0)
        whole = self.bag.read_bytes()
        draw = random.Random(1)
        seen = set()
        for number in range(25):
            damaged = bytearray(whole)
            for _ in range(draw.choice((1, 1, 2, 5, 20))):
                at = draw.randrange(len(damaged) - 4)
                kind = draw.randrange(3)
                if kind == 0:
                    damaged[at] ^= 1 << draw.randrange(8)
                elif kind == 1:
                    damaged[at : at + 4] = draw.choice((b"\xff\xff\xff\xff", bytes(4)))
                else:
                    del damaged[at : at + draw.randrange(1, 40)]
            self.bag.write_bytes(bytes(damaged))
            for options in ((), ("--salvage",)):
                with self.subTest(number, options=options):
                    status, _, errors = run_report(self.bag, "-o", self.out, "--no-figures",
                                                   *options)
                    self.assertIn(status, (0, 1, 2))
                    self.assertNotIn("Traceback", errors)
                    self.assertLess(errors.count("\n"), 5, errors)
                    seen.add(status)
        self.assertLessEqual({0, 2}, seen)

    def test_other_files_are_reported(self):
        self.refused()  # the file does not exist
        self.bag.write_bytes(b"")
        self.refused()
        self.bag.write_text("episode,t\n0,1\n")
        self.refused()
        self.refused("--salvage")
        self.bag.unlink()
        self.bag.mkdir()
        self.refused()

    def test_bag_without_a_run_is_reported(self):
        import std_msgs.msg

        with rosbag.Bag(str(self.bag), "w") as bag:
            bag.write("/chatter", std_msgs.msg.String("hello"))
        status, _, errors = run_report(self.bag, "-o", self.out)
        self.assertEqual(status, 1)
        self.assertIn("not a recorded run", errors)
        self.assertFalse(self.out.exists())


class Output(WithFolder):
    """Output that is written, and output that cannot be written."""

    def test_output_that_cannot_be_written_is_one_line(self):
        synthetic_bag.write(str(self.bag), 1.0)
        (self.folder / "file").write_text("")
        full = self.folder / "full"
        full.mkdir()
        (full / "poses.csv").symlink_to("/dev/full")
        for out in (self.folder / "file" / "out", full):
            status, output, errors = run_report(self.bag, "-o", out, "--no-figures")
            self.assertEqual((status, output), (2, ""))
            self.assertEqual(len(errors.splitlines()), 1, errors)
            self.assertIn(str(out), errors)

    def test_uncompressed_bag_is_said_to_be_unverified(self):
        synthetic_bag.write(str(self.bag), 1.0)
        _, output, _ = run_report(self.bag, "-o", self.out, "--no-figures")
        self.assertIn("no checksum", output)
        packed = self.folder / "packed.bag"
        with rosbag.Bag(str(self.bag)) as bag, rosbag.Bag(str(packed), "w", "bz2") as copy:
            for topic, message, time in bag.read_messages():
                copy.write(topic, message, time)
        _, output, _ = run_report(packed, "-o", self.out, "--no-figures")
        self.assertNotIn("checksum", output)
        content = bytearray(packed.read_bytes())
        inside = content.index(b"BZh") + 500
        content[inside : inside + 8] = bytes(8)
        packed.write_bytes(bytes(content))
        status, _, errors = run_report(packed, "-o", self.folder / "other", "--no-figures")
        self.assertEqual(status, 2, errors)


class CommandLine(unittest.TestCase):
    """The tool tells how it is used."""

    def test_help_names_every_option_and_a_missing_bag_is_wrong_usage(self):
        command = ["/usr/bin/python3", str(SCRIPTS / "bag_report.py"), "--help"]
        output = subprocess.run(
            command, stdout=subprocess.PIPE, universal_newlines=True, check=True
        ).stdout
        for option in ("--out", "--episode", "--salvage", "--no-figures", "--max-figures"):
            self.assertIn(option, output)
        self.assertEqual(run_report()[0], 2)


class Meshes(unittest.TestCase):
    """The vehicle's meshes are the ones that their script makes, and fit the collision sphere."""

    def test_committed_meshes_are_what_the_script_writes(self):
        for name, content in make_meshes.meshes().items():
            self.assertEqual((HERE.parent / "meshes" / name).read_bytes(), content, name)

    def test_the_vehicle_fits_its_collision_sphere(self):
        for triangle in make_meshes.lathe(make_meshes.profile()) + make_meshes.fittings():
            for x, y, z in triangle:
                self.assertLessEqual(x * x + y * y + z * z, 0.25)


if __name__ == "__main__":
    unittest.main()
