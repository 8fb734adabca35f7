#!/usr/bin/python3
"""Twenty AUVs, each with its own processes."""

import unittest

import rospy
import rostest
from auv_msgs.msg import LinkStates
from graph_listener import Latest, SummaryOf


class Swarm(unittest.TestCase):
    """One short episode in lockstep."""

    def test_twenty_auvs_fly_a_whole_episode(self):
        summary = SummaryOf(0)
        links = Latest("/acoustic_channel/links", LinkStates)
        message = summary.wait(55.0)
        self.assertTrue(message.complete)
        self.assertEqual(message.steps, 100)
        self.assertEqual(message.deadline_misses, 0)
        self.assertEqual(message.lost_rate, 0.0)
        # As `evaluate` flies it, which the graph repeats bit for bit.
        self.assertAlmostEqual(message.tail_distance, 0.0202, delta=0.0005)
        self.assertAlmostEqual(message.tracking_error, 0.0061, delta=0.0005)
        self.assertEqual(len(links.wait().links), 20 * 19)


if __name__ == "__main__":
    rospy.init_node("swarm_test")
    rostest.rosrun("stg_bringup", "swarm", Swarm)
