#!/usr/bin/python3
"""Faults at sea: bad messages, dead nodes, a silent modem, resets in the middle of an episode."""

import os
import pathlib
import signal
import tempfile
import time
import unittest

import rospkg
import rospy
import rostest
from auv_msgs.msg import AcousticReception, EpisodeSummary, SensorFrame, TaskState
from auv_msgs.srv import LoadPolicy, Pause, Reset
from geometry_msgs.msg import TwistStamped, WrenchStamped
from graph_listener import Diagnostics, Latest, kill, rosnode_pid, wait_for, wait_for_restart
from nav_msgs.msg import Odometry

NAN = float("nan")


class Faults(unittest.TestCase):
    """One long episode. Each test leaves all nodes as it found them."""

    @classmethod
    def setUpClass(cls):
        cls.diagnostics = Diagnostics()
        cls.frame = Latest("/auv_0/sensor_frame", SensorFrame)
        cls.odom = Latest("/auv_0/odom", Odometry)
        cls.task = Latest("/auv_0/task_state", TaskState)
        cls.wrench = Latest("/auv_0/wrench", WrenchStamped)
        cls.reception = Latest("/auv_0/acoustic/rx", AcousticReception)
        cls.summary = Latest("/episode_summary", EpisodeSummary)
        cls.wrench.wait(30.0)

    def setUp(self):
        self.task.wait_for_more(5)

    def refused(self, node, topic, reason):
        """Returns how many messages of `topic` the node says it refused."""
        return self.diagnostics.value(node, f"refused {topic}: {reason}")

    def check_refusals(self, node, topic, message_type, frames, spoil):
        """Sends spoilt messages of each kind. The node must refuse, count and show each kind.

        `frames` are the right frame and a wrong one. spoil(message) makes a number NaN.
        """
        publisher = rospy.Publisher(topic, message_type, queue_size=10)
        key = topic if node == "world" else topic.rsplit("/", 1)[1]
        wait_for(lambda: self.refused(node, key, "stale") is not None, 20.0, "diagnostics")
        wait_for(lambda: publisher.get_num_connections() > 0, 20.0, topic)
        for reason in ("not finite", "wrong frame", "stale"):
            before = self.refused(node, key, reason)

            def sent_and_refused(reason=reason, before=before):
                message = message_type()
                message.header.stamp = self.odom.message.header.stamp
                message.header.frame_id = frames[reason == "wrong frame"]
                if reason == "not finite":
                    spoil(message)
                elif reason == "stale":
                    message.header.stamp -= rospy.Duration(1.0)
                publisher.publish(message)
                return self.refused(node, key, reason) > before

            wait_for(sent_and_refused, 10.0, f"{node} refuses {topic}: {reason}")
            level, text, _ = self.diagnostics.nodes[node]
            self.assertGreaterEqual(level, 1)
            self.assertIn("refused", text)
        publisher.unregister()

    def test_bad_wrenches_are_refused_and_shown(self):
        def spoil(message):
            message.wrench.torque.y = NAN

        self.check_refusals(
            "world", "/auv_0/wrench", WrenchStamped, ("auv_0/base_link", "world"), spoil)
        position = self.odom.message.pose.pose.position
        self.assertTrue(all(abs(x) <= 1.0 for x in (position.x, position.y, position.z)))

    def test_bad_velocity_commands_are_refused_and_shown(self):
        def spoil(message):
            message.twist.linear.z = NAN

        self.check_refusals(
            "auv_0/controller", "/auv_0/cmd_vel", TwistStamped, ("world", "auv_0/base_link"), spoil)

    def test_agent_refuses_finite_numbers_that_would_break_it(self):
        publisher = rospy.Publisher("/auv_0/sensor_frame", SensorFrame, queue_size=10)
        wait_for(lambda: publisher.get_num_connections() > 0, 20.0, "the agent hears this test")
        wait_for(lambda: self.refused("auv_0/agent", "sensor_frame", "not finite") is not None,
                 20.0, "diagnostics")
        pid = rosnode_pid("/auv_0/agent")
        before = self.refused("auv_0/agent", "sensor_frame", "not finite")

        def sent_and_refused():
            huge = SensorFrame(header=self.frame.message.header, step=self.frame.message.step)
            huge.pose.position.x = 1e200
            huge.pose.orientation.w = 1.0
            publisher.publish(huge)
            return self.refused("auv_0/agent", "sensor_frame", "not finite") > before

        wait_for(sent_and_refused, 10.0, "the agent refuses a position of 1e200 m")
        publisher.unregister()
        self.task.wait_for_more(5)
        self.assertEqual(rosnode_pid("/auv_0/agent"), pid, "the agent lives on")

    def test_every_node_but_the_world_comes_back_after_its_death(self):
        for node in ("/auv_0/agent", "/auv_0/controller", "/acoustic_channel", "/metrics"):
            with self.subTest(node):
                pid = kill(node)
                wait_for_restart(node, pid)
                self.wrench.wait_for_more(10)
                fresh = self.wrench.message.header.stamp
                now = self.odom.message.header.stamp
                self.assertLess(abs((now - fresh).to_sec()), 0.5, "wrenches of the present")
                self.task.wait_for_more(5)
                self.reception.wait_for_more(5)

    def test_agents_go_on_while_the_channel_hangs_and_hear_again_after(self):
        wait_for(lambda: len(self.task.message.neighbours) == 3, 20.0, "neighbours known")
        pid = rosnode_pid("/acoustic_channel")
        os.kill(pid, signal.SIGSTOP)
        try:
            time.sleep(0.5)
            heard, step = self.reception.count, self.task.message.step
            # After ten seconds of silence, neighbours are forgotten.
            wait_for(lambda: not self.task.message.neighbours, 20.0, "neighbours forgotten")
            self.assertLessEqual(self.reception.count, heard + 1)
            self.assertGreater(self.task.message.step, step + 20)
        finally:
            os.kill(pid, signal.SIGCONT)
        wait_for(lambda: len(self.task.message.neighbours) == 3, 20.0, "neighbours known again")

    def test_one_stopped_agent_does_not_silence_the_others(self):
        others = [Latest(f"/auv_{i}/task_state", TaskState) for i in (1, 2, 3)]
        pid = rosnode_pid("/auv_0/agent")
        os.kill(pid, signal.SIGSTOP)
        try:
            # A channel that has just started does not know that AUV 0 is gone.
            wait_for_restart("/acoustic_channel", kill("/acoustic_channel"))
            for i, task in zip((1, 2, 3), others):
                heard = sorted({1, 2, 3} - {i})
                wait_for(lambda task=task, heard=heard:
                         task.message and sorted(task.message.neighbours) == heard,
                         20.0, f"AUV {i} hears AUVs {heard} and has forgotten AUV 0")
        finally:
            os.kill(pid, signal.SIGCONT)
        wait_for(lambda: sorted(others[0].message.neighbours) == [0, 2, 3], 20.0, "AUV 0 again")

    def test_reset_starts_the_asked_episode_and_its_seed(self):
        before = self.frame.message
        reset = rospy.ServiceProxy("/reset", Reset)
        response = reset(seed=4242, use_seed=True)
        self.assertTrue(response.success)
        self.assertEqual(response.episode, before.episode + 1)
        wait_for(lambda: self.frame.message.episode == response.episode, 10.0, "the new episode")
        self.assertEqual(self.frame.message.seed, 4242)
        self.assertGreater(self.frame.message.header.stamp, before.header.stamp)
        wait_for(lambda: self.summary.message and self.summary.message.episode == before.episode,
                 10.0, "a summary of the episode cut short")
        self.assertFalse(self.summary.message.complete)
        self.task.wait_for_more(5)
        self.assertEqual(self.task.message.episode, response.episode)
        self.assertEqual(reset(use_seed=False).episode, response.episode + 1)
        wait_for(lambda: self.frame.message.episode == response.episode + 1, 10.0, "the next one")
        self.assertEqual(self.frame.message.seed, 4243)

    def test_pause_stops_time_and_resume_goes_on(self):
        pause = rospy.ServiceProxy("/pause", Pause)
        self.assertTrue(pause(pause=True).success)
        time.sleep(0.3)
        stopped = self.frame.message
        time.sleep(1.0)
        self.assertEqual(self.frame.message.header.stamp, stopped.header.stamp)
        self.assertTrue(pause(pause=False).success)
        wait_for(lambda: self.frame.message.step >= stopped.step + 3, 10.0, "steps after the pause")

    def test_policy_is_replaced_while_running_and_a_bad_one_refused(self):
        load = rospy.ServiceProxy("/auv_0/agent/load_policy", LoadPolicy)
        bad = load(path="/nonexistent/policy.onnx")
        self.assertFalse(bad.success)
        self.assertIn("/nonexistent/policy.onnx", bad.message)
        self.assertEqual(bad.policy_id, "pursuit_separated")
        shipped = pathlib.Path(rospkg.RosPack().get_path("stg_bringup")) / "policies/medium.onnx"
        loaded = load(path=str(shipped))
        self.assertTrue(loaded.success, loaded.message)
        wait_for(lambda: self.task.message.policy_id == loaded.policy_id, 10.0, "the network")
        with tempfile.TemporaryDirectory() as folder:
            truncated = pathlib.Path(folder) / "truncated.onnx"
            truncated.write_bytes(shipped.read_bytes()[: shipped.stat().st_size // 2])
            bad = load(path=str(truncated))
        self.assertFalse(bad.success)
        self.assertIn("truncated.onnx", bad.message)
        self.assertEqual(bad.policy_id, loaded.policy_id, "keeps the one it has")
        self.assertTrue(load(path="idle").success)
        wait_for(lambda: self.task.message.policy_id == "idle", 10.0, "the idle policy")
        self.assertTrue(load(path="pursuit_separated").success)
        wait_for(lambda: self.task.message.policy_id == "pursuit_separated", 10.0, "the old policy")


if __name__ == "__main__":
    rospy.init_node("faults_test")
    rostest.rosrun("stg_bringup", "faults", Faults)
