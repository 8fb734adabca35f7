#!/usr/bin/env python3
"""A node that the world waits for hears the whole run, however slowly it subscribes."""

import collections
import unittest

import rospy
import rostest
from auv_msgs.msg import EpisodeSummary, SensorFrame
from graph_listener import wait_for

AGENTS = 4
PAUSE_S = 0.8  # on the wall clock between two subscriptions; the world waits longer than this
STEPS = 50


class LateListener(unittest.TestCase):
    def test_every_step_of_every_auv_is_heard(self):
        stamps, summaries = collections.defaultdict(set), []
        rospy.Subscriber("/episode_summary", EpisodeSummary, summaries.append)
        for i in range(AGENTS):
            rospy.rostime.wallsleep(PAUSE_S)
            rospy.Subscriber(f"/auv_{i}/sensor_frame", SensorFrame,
                             lambda frame, i=i: stamps[i].add(frame.header.stamp.to_nsec()))
        wait_for(lambda: summaries, 40.0, "the end of the run")
        rospy.rostime.wallsleep(0.5)
        for i in range(AGENTS):
            self.assertEqual(len(stamps[i]), STEPS + 1, f"/auv_{i}/sensor_frame")


if __name__ == "__main__":
    rospy.init_node("late_listener")
    rostest.rosrun("stg_bringup", "late_listener", LateListener)
