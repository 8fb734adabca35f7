#!/usr/bin/python3
"""Learning goes on while nodes run, if a node dies, stops or sends stamps of the future."""

import os
import pathlib
import shutil
import signal
import time
import unittest

import rospy
import rostest
from auv_msgs.msg import AgentStep
from graph_listener import Diagnostics, Latest, kill, rosnode_pid, wait_for, wait_for_restart
from mutations import stamped
from rosgraph_msgs.msg import Log


class TrainFaults(unittest.TestCase):
    """One training without end. Each test waits for the updates after its fault."""

    @classmethod
    def setUpClass(cls):
        cls.diagnostics = Diagnostics()
        cls.step = Latest("/auv_0/agent_step", AgentStep)
        cls.warnings = 0
        cls.log = rospy.Subscriber("/rosout", Log, cls.count)
        wait_for(lambda: cls.updates() >= 1, 60.0, "the first update")

    @classmethod
    def tearDownClass(cls):
        kill("/trainer")  # the trainer must end before its folder goes
        shutil.rmtree(pathlib.Path(rospy.get_param("~out")), ignore_errors=True)

    @classmethod
    def count(cls, message):
        """Counts the warnings of the trainer."""
        cls.warnings += message.name == "/trainer"

    @classmethod
    def updates(cls):
        """Returns how many updates the trainer has reported."""
        return cls.diagnostics.value("trainer", "updates") or 0

    def check_learning_goes_on(self, what, updates=3):
        """Waits for further updates."""
        before = self.updates()
        wait_for(lambda: self.updates() >= before + updates, 40.0, f"updates after {what}")

    def test_1_a_killed_metrics_node_stops_nothing(self):
        for attempt in range(3):
            wait_for_restart("/metrics", kill("/metrics"))
            self.check_learning_goes_on(f"death {attempt + 1} of the metrics node")

    def test_2_two_steps_of_the_future_stop_nothing(self):
        publisher = rospy.Publisher("/auv_0/agent_step", AgentStep, queue_size=10)
        wait_for(lambda: publisher.get_num_connections() > 0, 20.0, "the trainer hears this test")
        before = self.warnings
        for k in (1, 2):
            step = self.step.message
            future = stamped(step, step.header.stamp.to_sec() + 1e4 * k)
            future.episode += 100 * k
            publisher.publish(future)
        self.check_learning_goes_on("steps of the future", 5)
        publisher.unregister()
        self.assertLess(self.warnings - before, 60)

    def test_3_an_agent_that_slept_stops_nothing_for_good(self):
        pid = rosnode_pid("/auv_0/agent")
        before = self.warnings
        os.kill(pid, signal.SIGSTOP)
        try:
            time.sleep(8.0)
        finally:
            os.kill(pid, signal.SIGCONT)
        self.check_learning_goes_on("an agent's sleep")
        self.assertLess(self.warnings - before, 100)


if __name__ == "__main__":
    rospy.init_node("train_faults_test")
    rostest.rosrun("stg_bringup", "train_faults", TrainFaults)
