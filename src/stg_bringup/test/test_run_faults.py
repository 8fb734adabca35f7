"""A run tells what it was asked to do and did not do: at the start if it can know it, else at its end."""

import contextlib
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import threading
import time
import types
import unittest
import unittest.mock

import rosbag
from run_launcher import LAUNCH, launch, process_of, processes_with, stop
from stg_common.loading import load_program

HERE = pathlib.Path(__file__).resolve().parent
run_checks = load_program(HERE.parents[2] / "scripts" / "run" / "run_checks.py")

QUICK = ("episodes:=2", "real_time_factor:=0", "deadline:=20", "policy:=pursuit_separated",
         "table:=false", "overrides:=[time.episode_steps=40, time.tail_steps=10]")
ENDLESS = ("policy:=idle", "table:=false")
RED = "\033[31m"


class WithFolder(unittest.TestCase):
    """A test with its own folder, from which runs are started."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def start(self, *arguments, port=None):
        """Starts the medium scenario; returns (process, environment)."""
        process, environment = launch(self.folder, "medium.launch", *arguments, port=port)
        self.addCleanup(stop, process)
        return process, environment

    def finish(self, process, timeout_s=60):
        """Returns (exit status, output) of a run that ends by itself."""
        output = process.communicate(timeout=timeout_s)[0]
        return process.returncode, output

    def check_refused(self, reason, *arguments, port=None):
        """Starts a run. It must be refused in one line, before any node is started."""
        status, output = self.finish(self.start(*arguments, port=port)[0], 20)
        self.assertEqual(status, 1, output)
        self.assertRegex(output, f"stg: the run failed: .*{reason}")
        for word in ("Traceback", "started with pid", "process["):
            self.assertNotIn(word, output)


class Refused(WithFolder):
    """Faults that can be known before anything starts."""

    def test_bag_or_summary_where_nothing_can_be_written(self):
        self.check_refused("there is no folder", "record:=true", "bag:=nowhere/run.bag")
        self.check_refused("there is no folder", "summary_file:=nowhere/summary.csv")
        self.check_refused("is a folder", f"summary_file:={self.folder}")

    def test_a_log_folder_that_cannot_be_written(self):
        # No user can write there, not even root.
        with unittest.mock.patch.dict(os.environ, ROS_LOG_DIR="/proc/log"):
            self.check_refused("log folder '/proc/log': .*; ROS_LOG_DIR=FOLDER", *QUICK)

    def test_numbers_that_ros_cannot_carry(self):
        self.check_refused("seed: 5000000000 is more than 2147483647", "seed:=5000000000")
        self.check_refused("agents: 'abc' is not a whole number from 1 to 255", "agents:=abc")
        self.check_refused("agents: '256' is not a whole number from 1 to 255", "agents:=256")

    def test_as_many_agents_as_a_scenario_may_have(self):
        # A launch file includes itself, once for each AUV.
        listed = subprocess.run([str(LAUNCH), "--nodes", "stg_bringup", "medium.launch",
                                 "agents:=255"], cwd=self.folder, stdout=subprocess.PIPE,
                                universal_newlines=True, check=True,
                                env=dict(os.environ, PWD=str(self.folder))).stdout.split()
        self.assertEqual(sum(node.endswith("/agent") for node in listed), 255)

    def test_arguments_that_the_launch_file_does_not_know(self):
        self.check_refused("no argument 'episods'; did you mean 'episodes'", "episods:=1")
        self.check_refused("no argument 'foo'; it has scenario, ", "foo:=1")

    def test_a_replay_without_a_bag(self):
        for arguments, reason in (((), "requires the 'bag' arg to be set"),
                                  (("bag:=no such.bag",), "bag '.*/no such.bag': no such file")):
            process, _ = launch(self.folder, "replay.launch", "gui:=false", *arguments)
            self.addCleanup(stop, process)
            status, output = self.finish(process, 20)
            self.assertEqual(status, 1, output)
            self.assertRegex(output, reason)
            self.assertNotIn("Traceback", output)
            self.assertNotIn("process[", output)

    def test_external_agents_of_which_there_are_none(self):
        for external in ("[7]", "[2, 2]", "two"):
            process, _ = self.start(*QUICK, f"external:={external}")
            status, output = self.finish(process)
            self.assertEqual(status, 1, output)
            self.assertRegex(output, "parameter external: must be a list of different numbers from "
                                     "0 to 3, the indices of the AUVs")

    def test_a_stranger_on_the_port_of_the_master(self):
        for answer in (b"HTTP/1.0 200 OK\r\n\r\nhello", b"SSH-2.0-OpenSSH\r\n", None):
            with self.subTest(answer), self.stranger(answer) as port:
                self.check_refused("not a ROS master", *ENDLESS, port=port)

    @contextlib.contextmanager
    def stranger(self, answer):
        """Listens and gives an answer, or none. Yields its port."""
        with socket.socket() as listener:
            listener.bind(("127.0.0.1", 0))
            listener.listen()
            listener.settimeout(0.1)
            done, kept = threading.Event(), []

            def serve():
                while not done.is_set():
                    try:
                        peer = listener.accept()[0]
                    except OSError:
                        continue
                    kept.append(peer)
                    if answer:
                        peer.sendall(answer)
                        peer.close()

            server = threading.Thread(target=serve)
            server.start()
            try:
                yield listener.getsockname()[1]
            finally:
                done.set()
                server.join()
                for peer in kept:
                    peer.close()

    def test_a_second_run_on_the_same_master_leaves_the_first_alone(self):
        first, environment = self.start(*ENDLESS)
        world = process_of("/world", environment)
        process_of("/metrics", environment)
        port = int(environment["ROS_MASTER_URI"].rsplit(":", 1)[1])
        self.check_refused("runs already on the master", *QUICK, port=port)
        self.assertEqual(process_of("/world", environment), world)
        self.assertIsNone(first.poll())

    def test_a_full_disk_and_a_bag_that_was_cut_off(self):
        bag = self.folder / "run.bag"
        node = types.SimpleNamespace(package="rosbag", type="record",
                                     args=f"--output-name='{bag}' --lz4 /tf")
        outputs = run_checks.Outputs([node], {})
        self.assertEqual(outputs.bags, [str(bag)])
        outputs.check_before()
        with self.assertRaisesRegex(run_checks.Refusal, "not written to its end"):
            outputs.check_after()
        with rosbag.Bag(str(bag), "w") as opened:
            opened.write("/chatter", __import__("std_msgs.msg").msg.String("x"))
        outputs.check_after()
        full = types.SimpleNamespace(f_bavail=2**10, f_frsize=4096)
        with unittest.mock.patch("os.statvfs", lambda _: full):
            for check in (outputs.check_before, outputs.check_after):
                with self.assertRaisesRegex(run_checks.Refusal, "too little space"):
                    check()
        bag.write_bytes(bag.read_bytes()[:-100])
        with self.assertRaisesRegex(run_checks.Refusal, "is incomplete"):
            outputs.check_after()


class View(WithFolder):
    """The node of the view checks its parameters."""

    def test_bad_parameters_end_it_in_one_line(self):
        for argument, reason in (("trail_s:=-5", "trail_s: must be from 0"),
                                 ("vehicle_scale:=0", "vehicle_scale: must be from 0.001"),
                                 (f"scenario_file:={self.folder}", "scenario_file: cannot read")):
            with self.subTest(argument):
                process, _ = launch(self.folder, "view.launch", "rviz:=false", argument)
                self.addCleanup(stop, process)
                status, output = self.finish(process)
                self.assertEqual(status, 1, output)
                self.assertIn(reason, output)
                self.assertNotIn("what()", output)


class Ends(WithFolder):
    """The end of the world ends the run, and the run says how it ended."""

    def test_a_clean_end_is_no_death(self):
        for program in (LAUNCH, "roslaunch"):
            with self.subTest(program):
                process, environment = launch(self.folder, "medium.launch", *QUICK, program=program)
                self.addCleanup(stop, process)
                status, output = self.finish(process)
                self.assertEqual(status, 0, output)
                self.assertRegex(output, "world: 80 steps in")
                self.assertRegex(output, "agent 0: flies 'pursuit_separated'")
                for word in ("has died", "REQUIRED", RED, "escalating"):
                    self.assertNotIn(word, output)
                self.assertEqual(processes_with(environment["ROS_MASTER_URI"]), {}, output)

    def test_a_reader_that_leaves_ends_it(self):
        process, environment = self.start(*ENDLESS)
        process.stdout.readline()
        process.stdout.close()  # as `| head -1` does
        self.assertEqual(process.wait(60), 128 + signal.SIGPIPE)
        self.assertEqual(processes_with(environment["ROS_MASTER_URI"]), {})

    def test_a_death_is_told_with_its_signal(self):
        process, environment = self.start(*ENDLESS)
        process_of("/metrics", environment)
        os.kill(process_of("/world", environment), signal.SIGABRT)
        status, output = self.finish(process)
        self.assertEqual(status, 1, output)
        self.assertRegex(output, "REQUIRED process .world-[0-9]+. has died")
        self.assertIn(f"/world died with exit status -{int(signal.SIGABRT)}", output)
        self.assertEqual(processes_with(environment["ROS_MASTER_URI"]), {}, output)

    def test_a_world_does_not_outlive_what_roslaunch_watches(self):
        process, environment = self.start(*ENDLESS)
        process_of("/metrics", environment)
        os.kill(processes_with(environment["ROS_MASTER_URI"])["ends_launch"], signal.SIGKILL)
        status, output = self.finish(process)
        self.assertEqual(status, 1, output)
        self.assertEqual(processes_with(environment["ROS_MASTER_URI"]), {}, output)


class Lost(WithFolder):
    """Faults that are known only at the end or during the run."""

    def test_output_that_is_written_is_no_failure_whatever_its_name(self):
        process, _ = self.start(*QUICK, "record:=true", "bag:=my own run.bag",
                                "summary_file:=my own summary.csv")
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        with rosbag.Bag(str(self.folder / "my own run.bag")) as bag:
            self.assertEqual(bag.get_message_count("/episode_summary"), 2)
        self.assertEqual(len((self.folder / "my own summary.csv").read_text().splitlines()), 3)

    def test_bag_on_a_disk_that_gets_full(self):
        disk = self.folder / "disk"
        disk.mkdir()
        # A recording starts only if 1 GiB is free.
        mount = ["mount", "-t", "tmpfs", "-o", "size=1100M", "tmpfs", str(disk)]
        if subprocess.run(mount, stderr=subprocess.DEVNULL, check=False).returncode != 0:
            self.skipTest("may not mount a small disk")
        self.addCleanup(subprocess.run, ["umount", str(disk)], check=True)
        process, environment = self.start(*ENDLESS, "record:=true", "bag:=disk/run.bag",
                                          "episodes:=2", "real_time_factor:=20")
        process_of("/recorder", environment)
        end = time.monotonic() + 30.0
        while not (disk / "run.bag.active").exists() and time.monotonic() < end:
            time.sleep(0.1)
        with self.assertRaises(OSError), open(disk / "filler", "wb", buffering=0) as filler:
            while True:
                filler.write(bytes(2**20))
        status, output = self.finish(process)
        self.assertEqual(status, 1, output)
        self.assertRegex(output, "world: 1000 steps in", "the run itself goes on")
        self.assertRegex(output, "/recorder ended before the run, with exit status -6; "
                                 "too little space is free on the disk of '.*/disk/run.bag'")

    def test_a_run_without_a_home_is_a_run(self):
        homeless = self.folder / "homeless"
        homeless.write_text(f'#!/bin/sh\nunset HOME ROS_HOME\nexec "{LAUNCH}" "$@"\n')
        homeless.chmod(0o755)
        process, _ = launch(self.folder, "medium.launch", *QUICK, program=homeless)
        self.addCleanup(stop, process)
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)

    def test_a_home_of_ros_that_is_relative_is_one_folder(self):
        program = self.folder / "run"
        program.write_text(f'#!/bin/sh\nROS_HOME=here exec "{LAUNCH}" "$@"\n')
        program.chmod(0o755)
        process, _ = launch(self.folder, "medium.launch", *QUICK, program=program)
        self.addCleanup(stop, process)
        status, output = self.finish(process)
        self.assertEqual(status, 0, output)
        self.assertTrue(list((self.folder / "here" / "log").glob("*/rosout.log")))
        self.assertFalse((self.folder / "here" / "here").exists())

    def test_summary_on_a_full_disk(self):
        status, output = self.finish(self.start(*QUICK, "summary_file:=/dev/full")[0])
        self.assertEqual(status, 1, output)
        self.assertRegex(output, "cannot write '/dev/full': No space left")
        self.assertRegex(output, "2 episodes could not be written")

    def test_summary_that_lacks_episodes(self):
        outputs = run_checks.Outputs([], {"/metrics/summary_file": str(self.folder / "s.csv"),
                                          "/world/episodes": 2})
        with self.assertRaisesRegex(run_checks.Refusal, "s.csv"):
            outputs.check_after()
        (self.folder / "s.csv").write_text("episode,seed\n0,0\n")
        with self.assertRaisesRegex(run_checks.Refusal, "holds 1 of 2 episodes"):
            outputs.check_after()
        (self.folder / "s.csv").write_text("episode,seed\n0,0\n1,1\n")
        outputs.check_after()

    def test_death_of_the_recorder(self):
        process, environment = self.start(*ENDLESS, "record:=true", "bag:=run.bag",
                                          "episodes:=1", "real_time_factor:=20")
        os.kill(process_of("/recorder", environment), signal.SIGKILL)
        status, output = self.finish(process)
        self.assertEqual(status, 1, output)
        self.assertIn("/recorder ended before the run", output)

    def test_death_of_the_master_ends_the_run(self):
        process, environment = self.start(*ENDLESS)
        process_of("/metrics", environment)
        time.sleep(1.0)
        os.kill(processes_with(environment["ROS_MASTER_URI"])["rosmaster"], signal.SIGKILL)
        status, output = self.finish(process)
        self.assertEqual(status, 1, output)
        self.assertIn("/master died", output)
        self.assertEqual(processes_with(environment["ROS_MASTER_URI"]), {}, output)

    def test_metrics_that_are_gone_at_the_end(self):
        process, environment = self.start(*ENDLESS, "respawn:=false", "episodes:=1", "real_time_factor:=0",
                                          "deadline:=20", "overrides:=[time.episode_steps=4000]")
        os.kill(process_of("/metrics", environment), signal.SIGKILL)
        status, output = self.finish(process)
        self.assertEqual(status, 1, output)

    def test_motion_out_of_hand_names_the_vehicle_and_the_step(self):
        process, _ = self.start(
            "real_time_factor:=0", "policy:=pursuit", "table:=false",
            "overrides:=[vehicle.clip_velocity=false, 'vehicle.fully_actuated.linear_damping=[1e6,1e6,1e6,1e6,1e6,1e6]']")
        status, output = self.finish(process)
        self.assertEqual(status, 1, output)
        self.assertRegex(output, "state of AUV [0-3] is not finite or beyond 1e6 after step [0-9]+")


if __name__ == "__main__":
    unittest.main()
