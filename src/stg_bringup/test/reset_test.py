#!/usr/bin/python3
"""Resets in the middle of a step in lockstep: nothing is missed, and every episode is the same."""

import os
import signal
import time
import unittest

import rospy
import rostest
from auv_msgs.msg import SensorFrame
from auv_msgs.srv import Reset
from graph_listener import Diagnostics, rosnode_pid, wait_for

RESETS = 20
STEPS = 5  # steps of each episode that are compared


class Resets(unittest.TestCase):
    """A run without end."""

    @classmethod
    def setUpClass(cls):
        cls.diagnostics = Diagnostics()
        cls.starts = {}  # AUV 0's positions in its first steps, by episode
        cls.listener = rospy.Subscriber("/auv_0/sensor_frame", SensorFrame, cls.on_frame)
        cls.reset = rospy.ServiceProxy("/reset", Reset)
        wait_for(lambda: cls.starts, 30.0, "the first step")

    @classmethod
    def on_frame(cls, message):
        """Keeps the first positions of an episode."""
        p = message.pose.position
        if message.step <= STEPS:
            cls.starts.setdefault(message.episode, []).append((p.x, p.y, p.z))

    def start_again(self):
        """Asks for the same episode again, and returns its number."""
        response = self.reset(seed=7, use_seed=True)
        self.assertTrue(response.success, response.message)
        return response.episode

    def test_all_episodes_of_a_seed_are_the_same_and_nothing_is_missed(self):
        episodes = []
        for _ in range(RESETS):
            episode = self.start_again()
            wait_for(lambda episode=episode: len(self.starts.get(episode, [])) > STEPS, 60.0,
                     f"{STEPS} steps of episode {episode}")
            episodes.append(self.starts[episode])
        for flown in episodes[1:]:
            self.assertEqual(flown, episodes[0])
        wait_for(lambda: self.diagnostics.value("world", "steps with a deadline miss") is not None,
                 20.0, "the world's diagnostics")
        self.assertEqual(self.diagnostics.value("world", "steps with a deadline miss"), 0)

    def test_the_open_step_is_waited_for(self):
        pid = rosnode_pid("/auv_1/controller")
        os.kill(pid, signal.SIGSTOP)
        try:
            time.sleep(0.5)  # all messages have arrived now, except the command of AUV 1
            episode = self.start_again()
            time.sleep(1.0)
            self.assertNotIn(episode, self.starts, "begins before the open step is answered")
            self.assertEqual(self.start_again(), episode, "asked twice, it begins once")
        finally:
            os.kill(pid, signal.SIGCONT)
        wait_for(lambda: episode in self.starts, 30.0, "the new episode")


if __name__ == "__main__":
    rospy.init_node("reset_test")
    rostest.rosrun("stg_bringup", "reset", Resets)
