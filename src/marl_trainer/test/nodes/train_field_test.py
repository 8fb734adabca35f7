#!/usr/bin/python3
"""The trainer node of networks over entities: an end by a signal, a continuation, and refusals."""

import os
import pathlib
import shutil
import subprocess
import time
import unittest

import roslib.packages
import rosnode
import rospy
import rostest
from stg_common.stopped_trainer import learn_and_stop


class TrainField(unittest.TestCase):
    """The run of all nodes goes on, so further trainers learn from it."""

    refusals = 0

    @classmethod
    def setUpClass(cls):
        cls.out = pathlib.Path(rospy.get_param("~out"))
        cls.network = rospy.get_param("~network")
        cls.policies = pathlib.Path(roslib.packages.get_pkg_dir("stg_bringup")) / "policies"
        cls.program = roslib.packages.find_node("marl_trainer", "trainer_node")[0]
        for there in (True, False):  # the trainer of the launch file comes, learns and ends
            end = time.time() + 20.0
            while ("/trainer" in rosnode.get_node_names()) != there and time.time() < end:
                time.sleep(0.1)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.out)

    def learn(self, name, folder, *parameters):
        """Learns until the first update, ends the node by SIGTERM and returns what it printed."""
        words = [f"__name:={name}", "_episodes_per_update:=1", *parameters]
        return learn_and_stop(self.program, folder, words)

    def refused(self, *parameters):
        """Returns the message with which the node refuses to start."""
        # A name of its own, because parameters outlive a node.
        TrainField.refusals += 1
        name = f"refused_{self.refusals}"
        done = subprocess.run(
            [self.program, f"__name:={name}", f"_out:={self.out / name}"] + list(parameters),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            universal_newlines=True,
            timeout=20,
            check=False,
            env=dict(os.environ, ROSCONSOLE_STDOUT_LINE_BUFFERED="1"),
        )
        self.assertEqual(done.returncode, 2, done.stdout)
        return done.stdout

    def test_1_a_signal_ends_it_and_it_goes_on_from_its_folder(self):
        text = self.learn("continued", self.out, f"_network:={self.network}")
        self.assertRegex(text, r"update   [2-9] ")
        self.assertRegex(text, r"reward -?[\d.]+ kl -?[\d.]+ explained -?[\d.]+ sigma [\d.]+")

    def test_2_it_starts_from_the_shipped_policy(self):
        start = f"_start_policy:={self.policies / 'field.onnx'}"
        text = self.learn("started", self.out / "started", start)
        self.assertIn("-recorded-0-", text)

    def test_3_what_does_not_fit_is_refused_by_name(self):
        field = self.policies / "field.onnx"
        medium = self.policies / "medium.onnx"
        text = self.refused(f"_start_policy:={medium}", "_network:=pool")
        self.assertIn("has another observation layout", text)
        text = self.refused(f"_start_policy:={field}", "_network:=graph")
        self.assertIn("has the network 'pool' and the action 'law5', not 'graph'", text)
        text = self.refused(f"_start_policy:={field}", "_network:=layers")
        self.assertIn("is a network over entities", text)
        self.assertIn("is none of auto, layers", self.refused("_network:=tree"))
        text = self.refused("_network:=pool", f"_bags:={self.out}")
        self.assertIn("learns from a running graph only", text)
        text = self.refused("_network:=pool", f"_start_policy:={self.policies}")
        self.assertIn("holds no checkpoint of train_swarm", text)
        text = self.refused("_network:=pool", "_algorithm:=masac")
        self.assertIn("learns by mappo", text)

    def test_3b_what_would_have_no_effect_is_refused(self):
        text = self.refused(f"_network:={self.network}", "_critic_lr:=0.001")
        self.assertIn(f"parameter critic_lr: belongs to the network layers, but the network is {self.network}",
                      text)
        for name in ("critic_updates", "log_std", "noise_time", "last_command"):
            text = self.refused("_network:=layers", f"_{name}:=1")
            self.assertIn(f"parameter {name}: belongs to the networks pool and graph", text)
        for network, name in (("layers", "lr_final"), ("layers", "imitate"), (self.network, "leaving")):
            text = self.refused(f"_network:={network}", f"_{name}:=0.5")
            self.assertIn(f"parameter {name}: only a training in environments reads it", text)
        text = self.refused("_network:=layers", f"_start_policy:={self.policies / 'medium.onnx'}", "_activation:=tanh")
        self.assertIn("parameter activation: the policy to start from (start_policy) has its own", text)
        text = self.refused("_open_water:=false")
        self.assertIn("parameter open_water: must be true for the scenario", text)
        text = self.refused(f"_network:={self.network}", "_epoch:=3")
        self.assertIn("parameter epoch: this node does not read it, did you mean epochs?", text)

    def test_3c_an_impossible_noise_time_is_refused(self):
        for value, part in (("-1", "out of range"), ("1e5", "out of range"), ("a minute", "expected a number")):
            text = self.refused(f"_network:={self.network}", f"_noise_time:={value}")
            self.assertRegex(text, f"noise[_-]time: .*{part}")

    def test_3d_a_policy_that_sees_its_last_command_needs_a_training_that_allows_it(self):
        seeing = self.out / "seeing"
        words = (f"_network:={self.network}", "_noise_time:=0", "_last_command:=true")
        self.assertRegex(self.learn("seeing", seeing, *words), r"update   1 ")
        policy = seeing / "policy_last.onnx"
        self.assertNotIn(b"stg.noise_time_s", policy.read_bytes())
        self.assertIn(b"stg.noise_time_s", (self.out / "policy_last.onnx").read_bytes())
        self.assertIn("uses an input that this training withholds", self.refused(f"_start_policy:={policy}"))

    def test_4_a_policy_without_its_deviations_is_refused(self):
        broken = self.out / "broken.onnx"
        data = (self.policies / "field.onnx").read_bytes()
        self.assertEqual(data.count(b"stg.log_std"), 1)
        broken.write_bytes(data.replace(b"stg.log_std", b"stg.log_stx"))
        text = self.refused(f"_start_policy:={broken}")
        self.assertIn("metadata 'stg.log_std' is missing", text)


if __name__ == "__main__":
    rospy.init_node("train_field")
    rostest.rosrun("marl_trainer", "train_field_refusals", TrainField)
