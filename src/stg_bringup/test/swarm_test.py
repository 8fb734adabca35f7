#!/usr/bin/python3
"""Twenty AUVs, each with its own processes."""

import unittest

import rospy
import rostest
from auv_msgs.msg import AcousticReception, LinkStates, PacketEvent, PacketEvents, SwarmDisplay
from graph_listener import Latest, SummaryOf, wait_for


AGENTS = 20


class Swarm(unittest.TestCase):
    """One short episode in lockstep."""

    def test_twenty_auvs_fly_a_whole_episode(self):
        summary = SummaryOf(0)
        shown, received, heard = [], [], []
        rospy.Subscriber("/swarm_display", SwarmDisplay, shown.append, queue_size=100)
        rospy.Subscriber("/acoustic_channel/packets", PacketEvents, received.append, queue_size=100)
        rospy.Subscriber("/auv_3/acoustic/rx", AcousticReception, heard.append, queue_size=1000)
        links = Latest("/acoustic_channel/links", LinkStates)
        message = summary.wait(55.0)
        self.assertTrue(message.complete)
        self.assertEqual(message.steps, 100)
        self.assertEqual(message.deadline_misses, 0)
        self.assertEqual(message.lost_rate, 0.0)
        # `evaluate` flies the same, and the nodes repeat it bit for bit.
        self.assertAlmostEqual(message.tail_distance, 0.0202, delta=0.0005)
        self.assertAlmostEqual(message.tracking_error, 0.0061, delta=0.0005)
        self.assertEqual(len(links.wait().links), AGENTS * (AGENTS - 1))
        # Displays get few messages, but they get the ends of an episode and each packet.
        wait_for(lambda: any(m.state.episode == 1 for m in shown), 5.0, "the next episode")
        first = [m for m in shown if m.state.episode == 0]
        steps = [m.state.step for m in first]
        self.assertEqual([steps[0], steps[-1]], [0, 100])
        self.assertEqual(steps, sorted(set(steps)))
        self.assertTrue(all(task.step == m.state.step for m in first for task in m.tasks))
        self.assertTrue(any(m.agents == tuple(range(AGENTS)) for m in first))
        end = first[-1].header.stamp
        # Each topic arrives in a thread of its own; on a busy machine one may be behind.
        wait_for(lambda: received and received[-1].header.stamp > end, 20.0, "all packets of the episode")
        delivered = {(e.source, e.sequence) for m in received for e in m.events
                     if (e.kind, e.receiver) == (PacketEvent.DELIVERED, 3)}  # fmt: skip
        # The comparison begins when both topics are connected.
        begin = rospy.Time.from_sec(received[0].header.stamp.to_sec() + 1.0)
        told = {(p.source, p.sequence) for m in heard if begin < m.header.stamp <= end for p in m.packets}
        self.assertGreater(len(told), 100)
        self.assertLessEqual(told, delivered)


if __name__ == "__main__":
    rospy.init_node("swarm_test")
    rostest.rosrun("stg_bringup", "swarm", Swarm)
