#!/usr/bin/python3
"""The trainer node learns while nodes run, then from good and damaged bags of the run."""

import copy
import math
import os
import pathlib
import shutil
import subprocess
import threading
import unittest

import roslib.packages
import rosbag
import rosnode
import rospy
import rostest
from auv_msgs.msg import AgentStep, StepReport
from auv_msgs.srv import LoadPolicy
from graph_listener import wait_for
from std_msgs.msg import String
from stg_common.stopped_trainer import learn_and_stop

AGENTS, STEPS = 4, 40
REPORT = "/step_report"


class Recorder:
    """Keeps what the trainer needs of each episode."""

    def __init__(self):
        self.episodes = {}  # {number: [(topic, message)]}
        self.policies = []  # ids in the order of their first decisions
        self._lock = threading.Lock()
        self._subscribers = [
            rospy.Subscriber(f"/auv_{i}/agent_step", AgentStep, self._keep, f"/auv_{i}/agent_step")
            for i in range(AGENTS)
        ]
        self._subscribers.append(rospy.Subscriber(REPORT, StepReport, self._keep, REPORT))

    def _keep(self, message, topic):
        with self._lock:
            self.episodes.setdefault(message.episode, []).append((topic, message))
            policy = getattr(message, "policy_id", None)
            if policy and policy not in self.policies:
                self.policies.append(policy)

    def whole(self, policy):
        """Returns the episodes that one policy flew from start to end."""
        with self._lock:
            found = []
            for number in sorted(self.episodes):
                messages = list(self.episodes[number])
                steps = [m for topic, m in messages if topic != REPORT and m.step < STEPS]
                if (
                    len(steps) == AGENTS * STEPS
                    and len(messages) - sum(topic != REPORT for topic, _ in messages) == STEPS
                    and all(m.policy_id == policy for m in steps)
                ):
                    found.append(messages)
            return found


def write_bag(path, messages):
    """Writes messages in the order in which they came."""
    with rosbag.Bag(str(path), "w") as bag:
        for topic, message in messages:
            bag.write(topic, message, message.header.stamp)


def changed(messages, change):
    """Returns a copy of the messages. `change` has changed one step of AUV 2."""
    copies = copy.deepcopy(messages)
    step = next(m for topic, m in copies if topic == "/auv_2/agent_step" and m.step == 17)
    step.observation, step.action = list(step.observation), list(step.action)
    change(step)
    return copies


class TrainOnline(unittest.TestCase):
    """One run of all nodes. Its recordings serve all tests."""

    @classmethod
    def setUpClass(cls):
        cls.out = pathlib.Path(rospy.get_param("~out"))
        cls.bags = cls.out / "bags"
        cls.recorder = Recorder()
        wait_for(lambda: "/trainer" in rosnode.get_node_names(), 20.0, "the trainer starts")
        wait_for(lambda: "/trainer" not in rosnode.get_node_names(), 60.0, "the trainer ends")
        cls.load = rospy.ServiceProxy("/auv_0/agent/load_policy", LoadPolicy)
        cls.policy = cls.load(str(cls.out / "policy_last.onnx")).policy_id
        cls.episodes = wait_for(
            lambda: len(cls.recorder.whole(cls.policy)) >= 3 and cls.recorder.whole(cls.policy),
            30.0,
            "three episodes with the last policy",
        )[:3]
        cls.bags.mkdir()
        write_bag(cls.bags / "good.bag", cls.episodes[0] + cls.episodes[1])

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.out)

    def train(self, name, *bags):
        """Runs the trainer with bags, in a copy of the run's folder."""
        folder = self.out / name
        folder.mkdir()
        for path in [*self.out.glob("checkpoint_*.ckpt"), self.out / "policy_last.onnx"]:
            shutil.copy(path, folder)
        program = roslib.packages.find_node("marl_trainer", "trainer_node")[0]
        done = subprocess.run(
            [program, f"__name:={name}", f"_out:={folder}"]
            + ["_bags:=" + " ".join(str(bag) for bag in bags)],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            universal_newlines=True,
            timeout=60,
            check=False,
            env=dict(os.environ, ROSCONSOLE_STDOUT_LINE_BUFFERED="1"),
        )
        return done.returncode, done.stdout, folder / "policy_last.onnx"

    def damaged(self):
        """Writes a folder of bags, each with one fault."""
        folder = self.bags / "damaged"
        if folder.exists():
            return folder
        folder.mkdir()
        episode = self.episodes[2]
        write_bag(folder / "gap.bag", [m for m in episode if m[0] != "/auv_1/agent_step"])
        write_bag(
            folder / "foreign.bag",
            changed(episode, lambda step: setattr(step, "policy_id", "another")),
        )
        write_bag(
            folder / "nan.bag",
            changed(episode, lambda step: step.observation.__setitem__(5, math.nan)),
        )
        write_bag(
            folder / "action.bag",
            changed(episode, lambda step: step.action.__setitem__(0, step.action[0] + 1.0)),
        )
        whole = (self.bags / "good.bag").read_bytes()
        (folder / "truncated.bag").write_bytes(whole[: len(whole) // 2])
        (folder / "noise.bag").write_bytes(whole[:4096] + os.urandom(20000))
        (folder / "empty.bag").write_bytes(b"")
        return folder

    def test_1_each_update_gave_the_agents_a_new_policy(self):
        trained = [policy for policy in self.recorder.policies if policy.startswith("medium-")]
        self.assertEqual(len(trained), 3, self.recorder.policies)
        self.assertIn("-0-", trained[0])
        self.assertIn(f"-{2 * STEPS}-", trained[1])
        self.assertEqual(trained[2], self.policy)

    def test_2_a_good_bag_makes_a_new_policy_that_agents_load(self):
        code, text, onnx = self.train("good", self.bags / "good.bag")
        self.assertEqual(code, 0, text)
        self.assertIn("2 episodes used, 0 dropped\n", text)
        answer = self.load(str(onnx))
        self.assertTrue(answer.success, answer.message)
        self.assertNotEqual(answer.policy_id, self.policy)
        self.assertIn(f"-{6 * STEPS}-", answer.policy_id)

    def test_3_damaged_bags_are_told_and_dropped_and_good_ones_used(self):
        code, text, _ = self.train("mixed", self.damaged(), self.bags / "good.bag")
        self.assertEqual(code, 0, text)
        self.assertIn(
            "2 episodes used, 4 dropped (1 steps missing, 1 NaN or infinity, 1 another policy, "
            "1 wrong log probability), 3 bags unreadable",
            text,
        )
        for name in ("truncated", "noise", "empty"):
            self.assertRegex(text, rf"{name}\.bag: damaged bag")

    def test_4_without_a_good_episode_nothing_changes(self):
        code, text, onnx = self.train("bad", self.damaged())
        self.assertEqual(code, 2, text)
        self.assertIn("no episode to learn from", text)
        self.assertEqual(onnx.read_bytes(), (self.out / "policy_last.onnx").read_bytes())

    def test_5_a_bag_of_another_scenario_is_refused(self):
        path = self.bags / "scenario.bag"
        write_bag(path, self.episodes[2])
        with rosbag.Bag(str(path), "a") as bag:
            stamp = self.episodes[2][0][1].header.stamp
            bag.write("/scenario", String("name: other\n"), stamp)
        code, text, _ = self.train("other_world", path)
        self.assertEqual(code, 2, text)
        self.assertIn("recorded in another scenario", text)

    def test_6_sigterm_ends_live_training_with_the_last_update_kept(self):
        folder = self.out / "stopped"
        program = roslib.packages.find_node("marl_trainer", "trainer_node")[0]
        learn_and_stop(program, folder, ["__name:=stopped", "_episodes_per_update:=2"])


if __name__ == "__main__":
    rospy.init_node("train_online_test")
    rostest.rosrun("stg_bringup", "train_online", TrainOnline)
