#!/usr/bin/python3
"""The node of emulated modems: a vehicle whose odometry stops is away, and it may come back."""

import time
import unittest

import rospy
import rostest
from auv_msgs.msg import AcousticPacket, AcousticReception
from nav_msgs.msg import Odometry

from fleet_world import wait_for


class Modems(unittest.TestCase):
    """Plays the vehicle alpha beside a moored one, on the wall clock."""

    def setUp(self):
        self.heard = []
        self.odom = rospy.Publisher("/alpha/odom", Odometry, queue_size=10)
        self.tx = rospy.Publisher("/buoy/acoustic/tx", AcousticPacket, queue_size=10)
        self.rx = rospy.Subscriber("/alpha/acoustic/rx", AcousticReception,
                                   lambda m: self.heard.extend(p.data for p in m.packets))
        wait_for(lambda: all(c.get_num_connections() > 0 for c in (self.odom, self.tx, self.rx)),
                 30.0, "the modems")

    def stay(self, seconds):
        """Publishes odometry ten times in a second."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            message = Odometry()
            message.header.stamp, message.header.frame_id = rospy.Time.now(), "world"
            message.pose.pose.position.z = -20.0
            message.pose.pose.orientation.w = 1.0
            self.odom.publish(message)
            time.sleep(0.1)

    def say(self, data):
        self.tx.publish(AcousticPacket(destination=-1, data=data))

    def test_a_vehicle_that_was_silent_comes_back(self):
        self.stay(0.5)
        self.say(b"one")
        self.stay(2.0)
        self.assertEqual([b"one"], self.heard)
        time.sleep(2.0)  # longer than silent_after
        self.say(b"two")
        time.sleep(2.0)
        self.stay(0.5)
        self.say(b"three")
        self.stay(2.0)
        self.assertEqual([b"one", b"three"], self.heard)


if __name__ == "__main__":
    rospy.init_node("modems_test")
    rostest.rosrun("acoustic_channel", "modems", Modems)
