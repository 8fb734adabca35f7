"""A user's whole run: launch, recording, clean exit, metrics file, replay of the bag."""

import collections
import csv
import json
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

import rosbag
import rosgraph


from graph_listener import wait_for
from run_launcher import free_port, launch, process_of, processes_with, stop

STEPS = 60
AGENTS = 4
OF_EVERY_STEP = ("odom", "sensor_frame", "cmd_vel", "wrench", "acoustic/rx", "task_state",
                 "agent_step")
SLOTS = 5  # decisions between two packets of an AUV


class RecordReplay(unittest.TestCase):
    """One short recorded run, made once for all tests."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.temporary.name)
        process, _ = launch(
            cls.folder, "medium.launch", "episodes:=1", "real_time_factor:=0", "deadline:=20",
            "policy:=pursuit_separated", "record:=true", "bag:=run.bag",
            f"overrides:=[time.episode_steps={STEPS}, time.tail_steps=20]",
            "summary_file:=summary.json")
        try:
            cls.output = process.communicate(timeout=60)[0]
        except subprocess.TimeoutExpired:
            cls.output = stop(process)
        cls.status = process.returncode
        cls.bag = cls.folder / "run.bag"

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def test_run_ends_by_itself_with_status_0_and_shows_its_metrics(self):
        self.assertEqual(self.status, 0, self.output)
        self.assertIn("tail_distance", self.output)
        self.assertIn("0 with a deadline miss", self.output)

    def test_summary_file_holds_the_episode(self):
        lines = (self.folder / "summary.json").read_text().splitlines()
        self.assertEqual(len(lines), 1)
        summary = json.loads(lines[0])
        self.assertTrue(summary["complete"])
        self.assertEqual(summary["steps"], STEPS)

    def test_bag_holds_every_step_of_every_auv(self):
        stamps = collections.defaultdict(set)
        reports = []
        with rosbag.Bag(str(self.bag)) as bag:
            for topic, message, _ in bag.read_messages():
                if hasattr(message, "header"):
                    stamps[topic].add(message.header.stamp.to_nsec())
                if topic == "/step_report":
                    reports.append(message)
        clock = sorted(stamps["/auv_0/odom"])
        self.assertEqual(len(clock), STEPS + 1)
        self.assertEqual({b - a for a, b in zip(clock, clock[1:])}, {100_000_000})
        for i in range(AGENTS):
            for name in OF_EVERY_STEP:
                told = stamps[f"/auv_{i}/{name}"]
                if name == "acoustic/rx":
                    # Packets that arrive in a step have the stamp of its end. Nothing was sent in the first
                    # step, so the recorder may have it or not.
                    self.assertLessEqual(set(clock[1:]), told, f"/auv_{i}/{name}")
                    self.assertIn(len(told), (STEPS + 1, STEPS + 2), f"/auv_{i}/{name}")
                else:
                    self.assertEqual(len(told), STEPS + 1, f"/auv_{i}/{name}")
            self.assertEqual(sorted(stamps[f"/auv_{i}/acoustic/tx"]), clock[i % SLOTS::SLOTS])
        self.assertEqual([r.step for r in reports], list(range(STEPS)))
        self.assertTrue(reports[-1].truncated)
        self.assertEqual(len(reports[-1].final_state), len(reports[-1].global_state))

    def test_replay_publishes_what_was_recorded(self):
        port = free_port()
        environment = dict(os.environ, ROS_MASTER_URI=f"http://127.0.0.1:{port}",
                           ROS_IP="127.0.0.1", ROS_HOME=str(self.folder / "ros_home"))
        output = self.folder / "replayed.bag"
        topics = {"/auv_0/odom", "/auv_3/task_state"}
        programs = []
        try:
            programs.append(subprocess.Popen(["roscore", "-p", str(port)], env=environment,
                                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
            master = rosgraph.Master("/record_replay", master_uri=environment["ROS_MASTER_URI"])
            wait_for(master.is_online, 40.0, "a master")
            programs.append(subprocess.Popen(
                ["rosrun", "rosbag", "record", "-q", "-O", str(output), *topics], env=environment))
            # The recorder listens before the replay begins, however busy the machine is.
            wait_for(lambda: topics <= {name for name, _ in master.getSystemState()[1]}, 40.0,
                     "the recorder listens")
            process, _ = launch(self.folder, "replay.launch", "bag:=run.bag", "gui:=false",
                                "rate:=4", "delay:=3", port=port)
            programs.append(process)
            process.communicate(timeout=80)
        finally:
            for program in reversed(programs):  # the recorder closes its bag before the master ends
                stop(program)
        for topic in ("/auv_0/odom", "/auv_3/task_state"):
            with rosbag.Bag(str(self.bag)) as bag, rosbag.Bag(str(output)) as replayed:
                before = [m for _, m, _ in bag.read_messages(topics=[topic])]
                after = [m for _, m, _ in replayed.read_messages(topics=[topic])]
            self.assertGreater(len(after), STEPS // 2)
            self.assertEqual(after, before[len(before) - len(after):])

    def test_replay_from_the_middle_has_the_scenario_and_the_static_frames(self):
        # Both are published once, before the part that is shown. This part lasts 150 s here.
        process, environment = launch(self.folder, "replay.launch", "bag:=run.bag", "gui:=false",
                                      "start:=3", "rate:=0.02", "delay:=0.1")
        try:
            for topic, content in (("/scenario", "name: medium"), ("/tf_static", "world_ned")):
                heard = subprocess.run(
                    ["timeout", "60", "bash", "-c",
                     f"until rostopic echo -n 1 {topic} 2>/dev/null; do sleep 0.2; done"],
                    env=environment, stdout=subprocess.PIPE, universal_newlines=True, check=False)
                self.assertIn(content, heard.stdout, topic)
        finally:
            stop(process)


class ExitStatus(unittest.TestCase):
    """The exit status of a run shows that it failed, and the run ends."""

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)

    def launch(self, *arguments):
        """Starts the medium scenario without end; `arguments` may change this."""
        process, environment = launch(self.folder, "medium.launch", "table:=false", *arguments)
        self.addCleanup(stop, process)
        return process, environment

    def test_unknown_policy_ends_the_run_with_status_1(self):
        process, _ = self.launch("policy:=nonesuch.onnx")
        output = process.communicate(timeout=40)[0]
        self.assertEqual(process.returncode, 1, output)
        self.assertIn("agent refuses its configuration", output)
        self.assertIn(f"{self.folder}/nonesuch.onnx", output)

    def test_death_of_the_world_ends_the_run_with_status_1(self):
        process, environment = self.launch()
        process_of("/metrics", environment)  # this is the last node to start
        time.sleep(1.0)
        os.kill(process_of("/world", environment), signal.SIGKILL)
        output = process.communicate(timeout=40)[0]
        self.assertEqual(process.returncode, 1, output)
        self.assertIn("/world died with exit status -9", output)

    def test_death_of_the_world_while_nodes_start_leaves_nothing_running(self):
        # roslaunch alone leaves the master or nodes behind in about eight of ten such runs.
        for _ in range(3):
            process, environment = self.launch()
            found = {}
            end = time.monotonic() + 30
            while "world" not in found and time.monotonic() < end:
                found = processes_with(environment["ROS_MASTER_URI"])
            os.kill(found["world"], signal.SIGKILL)
            output, _ = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 1, output)
            self.assertEqual(processes_with(environment["ROS_MASTER_URI"]), {}, output)

    def test_interrupted_run_ends_with_status_0(self):
        process, environment = self.launch()
        process_of("/metrics", environment)  # this is the last node to start
        time.sleep(1.0)  # before all nodes are started, an interrupt would end it with 130
        output = stop(process)
        self.assertEqual(process.returncode, 0, output)


class SummaryFile(unittest.TestCase):
    """The file of a run whose metrics node dies and comes back."""

    def test_restarted_node_goes_on_with_the_rows_of_the_run_and_a_new_run_starts_anew(self):
        policy = "pursuit_separated:gain=2,cap=0.5"
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            file = folder / "summary.csv"
            file.write_text("of an earlier run\n")
            process, environment = launch(
                folder, "medium.launch", "episodes:=8", "real_time_factor:=10", "table:=false",
                f"policy:={policy}", "summary_file:=summary.csv",
                f"overrides:=[time.episode_steps={STEPS}, time.tail_steps=20]")
            try:
                end = time.monotonic() + 40.0
                while file.read_text().count("\n") < 2:
                    self.assertLess(time.monotonic(), end, "no first episode")
                    time.sleep(0.05)
                first = file.read_text()
                os.kill(process_of("/metrics", environment), signal.SIGKILL)
                output = process.communicate(timeout=40)[0]
            finally:
                stop(process)
            text = file.read_text()
            self.assertTrue(text.startswith(first), text)
            rows = list(csv.DictReader(text.splitlines()))
            episodes = [row["episode"] for row in rows]
            self.assertEqual((episodes[0], episodes[-1]), ("0", "7"), output)
            self.assertEqual(len(set(episodes)), len(episodes), "no second header, nothing twice")
            self.assertEqual({row["policy"] for row in rows}, {policy})
            self.assertIn("band_rate", rows[0])
            self.assertNotIn(None, rows[0], "as many fields as names")


if __name__ == "__main__":
    unittest.main()
