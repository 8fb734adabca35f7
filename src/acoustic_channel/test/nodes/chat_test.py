#!/usr/bin/python3
"""The example of the docs: two scripted vehicles chat on the wall clock."""

import unittest

import rospy
import rostest
from auv_msgs.msg import AcousticReception, TransmitStatus


from fleet_world import wait_for


class Chat(unittest.TestCase):
    """Listens to both vehicles."""

    def test_question_and_answer_go_to_and_fro(self):
        heard = {"alpha": [], "beta": []}
        statuses = []
        subscribers = [
            rospy.Subscriber(f"/{name}/acoustic/rx", AcousticReception,
                             lambda m, name=name: heard[name].extend(m.packets)) for name in heard]
        subscribers.append(
            rospy.Subscriber("/beta/acoustic/status", TransmitStatus, statuses.append))
        wait_for(lambda: len(heard["alpha"]) >= 2, 60.0, "two answers")
        for packet in heard["alpha"]:
            self.assertEqual(packet.data, b"beta is 600.0 m east")
            self.assertEqual((packet.source, packet.destination), (1, 0))
            self.assertAlmostEqual(packet.travel_time, 0.4, delta=1e-6)
        for packet in heard["beta"]:
            self.assertEqual(packet.data, b"where are you?")
            self.assertEqual((packet.source, packet.destination), (0, -1))
        kinds = [s.status for s in statuses]
        self.assertIn(TransmitStatus.QUEUED, kinds)
        self.assertIn(TransmitStatus.SENT, kinds)
        self.assertEqual(len(subscribers), 3)


if __name__ == "__main__":
    rospy.init_node("chat_test")
    rostest.rosrun("acoustic_channel", "chat", Chat)
