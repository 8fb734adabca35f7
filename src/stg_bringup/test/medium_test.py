#!/usr/bin/python3
"""The medium scenario from end to end: metrics, independent agents, diagnostics."""

import unittest

import rosgraph
import rospy
import rostest
from graph_listener import Diagnostics, SummaryOf, wait_for

AGENTS = 4


def foreign_subscriptions(subscribers):
    """Returns the (node, topic) pairs of agents that hear more than their own sensors.

    `subscribers` is the master's list of [topic, [nodes]].
    """
    foreign = []
    for topic, nodes in subscribers:
        for node in nodes:
            if not node.endswith("/agent"):
                continue
            own = node[: -len("agent")]
            allowed = {own + name for name in
                       ("sensor_frame", "acoustic/rx")}
            if topic not in allowed | {"/clock"}:
                foreign.append((node, topic))
    return foreign


class Medium(unittest.TestCase):
    """One run in lockstep, seen from outside."""

    @classmethod
    def setUpClass(cls):
        cls.diagnostics = Diagnostics()
        cls.summary = SummaryOf(0)

    def test_shipped_policy_holds_the_target_and_no_deadline_is_missed(self):
        summary = self.summary.wait(50.0)
        self.assertTrue(summary.complete)
        self.assertEqual(summary.steps, 500)
        self.assertEqual(summary.deadline_misses, 0)
        self.assertNotIn(summary.policy_id, ("", "idle", "pursuit", "pursuit_separated"))
        self.assertEqual(summary.lost_rate, 0.0)
        # `evaluate` flies seed 0 like this, and the nodes repeat it bit for bit.
        self.assertAlmostEqual(summary.tail_distance, 0.0149, delta=0.0002)
        self.assertAlmostEqual(summary.tracking_error, 0.00018, delta=0.00005)
        self.assertAlmostEqual(summary.time_to_band, 5.6, delta=0.2)
        self.assertAlmostEqual(summary.communication_quality, 0.739, delta=0.005)
        self.assertEqual(summary.tail_colliding_pairs, 0.0)

    def test_agents_hear_their_own_sensors_and_modem_only(self):
        self.summary.wait(50.0)
        _, subscribers, _ = rosgraph.Master("/stg_test").getSystemState()
        agents = {node for _, nodes in subscribers for node in nodes if node.endswith("/agent")}
        self.assertEqual(len(agents), AGENTS)
        self.assertEqual(foreign_subscriptions(subscribers), [])

    def test_without_a_search_map_no_agent_offers_one(self):
        self.summary.wait(50.0)
        topics = {topic for topic, _ in rosgraph.Master("/stg_test").getPublishedTopics("")}
        self.assertIn("/auv_0/acoustic/tx", topics)
        self.assertNotIn("/auv_0/search_map", topics)

    def test_check_of_subscriptions_finds_ground_truth_and_neighbours(self):
        truth = [["/target_0/odom", ["/auv_1/agent"]]]
        neighbour = [["/auv_0/sensor_frame", ["/auv_0/agent", "/auv_1/agent"]]]
        self.assertEqual(foreign_subscriptions(truth), [("/auv_1/agent", "/target_0/odom")])
        self.assertEqual(foreign_subscriptions(neighbour), [("/auv_1/agent", "/auv_0/sensor_frame")])

    def test_every_node_reports_its_health(self):
        nodes = {"world", "acoustic_channel", "metrics"}
        nodes |= {f"auv_{i}/{name}" for i in range(AGENTS) for name in ("agent", "controller")}
        wait_for(lambda: nodes <= set(self.diagnostics.nodes), 20.0, f"diagnostics of {nodes}")
        wait_for(lambda: (self.diagnostics.value("world", "steps per second") or 0.0) > 0.0, 20.0,
                 "a rate of the world")
        for key in ("age of information, mean [s]", "packets dropped: loss"):
            self.assertIsNotNone(self.diagnostics.value("acoustic_channel", key), key)


if __name__ == "__main__":
    rospy.init_node("medium_test")
    rostest.rosrun("stg_bringup", "medium", Medium)
