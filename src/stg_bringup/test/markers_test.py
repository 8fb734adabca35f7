#!/usr/bin/python3
"""Publishes a run with known content and checks the markers of the marker node."""

import math
import threading
import unittest

import auv_msgs.msg
import nav_msgs.msg
import rospy
import rostest
import std_msgs.msg
import visualization_msgs.msg


import synthetic_bag
from graph_listener import Diagnostics, wait_for

Marker = visualization_msgs.msg.Marker
TASK = auv_msgs.msg.TaskState
LISTS = (Marker.LINE_LIST, Marker.LINE_STRIP, Marker.SPHERE_LIST)


class Run:
    """Publishers of everything the marker node listens to."""

    def __init__(self):
        def latched(topic, kind):
            return rospy.Publisher(topic, kind, queue_size=10, latch=True)

        agents = range(synthetic_bag.AGENTS)
        self.odom = [latched(f"/auv_{i}/odom", nav_msgs.msg.Odometry) for i in agents]
        self.task = [latched(f"/auv_{i}/task_state", TASK) for i in agents]
        self.target = latched("/target_0/odom", nav_msgs.msg.Odometry)
        self.links = latched("/acoustic_channel/links", auv_msgs.msg.LinkStates)
        self.packets = rospy.Publisher("/acoustic_channel/packets", auv_msgs.msg.PacketEvents,
                                       queue_size=10)
        self.scenario = latched("/scenario", std_msgs.msg.String)
        self.scenario.publish(synthetic_bag.SCENARIO.replace("1.0}", "2.0}"))

    def publish(self, k, dropped=0, position=None, clash=None):
        """Publishes step k. `dropped` packets are lost on every link. AUV 0 is at `position` if it is given.
        `clash`: AUV 1 sends for a second, and AUV 2 loses its packet for that reason."""
        t = k * synthetic_bag.STEP_S
        stamp = rospy.Time(1, 0) + rospy.Duration.from_sec(t)
        target = synthetic_bag.odometry("target_0", stamp, synthetic_bag.target_at(t), (1, 0))
        self.target.publish(target)
        for i, (odom, task) in enumerate(zip(self.odom, self.task)):
            place = position if i == 0 and position else synthetic_bag.auv_at(i, t)
            frame = f"auv_{i}/base_link"
            odom.publish(synthetic_bag.odometry(frame, stamp, place, (1, 0)))
            state = synthetic_bag.task_state(stamp, k, i)
            state.phase = i
            task.publish(state)
        links = synthetic_bag.link_states(stamp, k)
        for link in links.links:
            link.dropped, link.last_drop_reason = dropped, link.RANGE
        self.links.publish(links)
        if clash is not None:
            kinds = auv_msgs.msg.PacketEvent
            common = {"source": 1, "transmit": stamp, "airtime": 1.0}
            events = auv_msgs.msg.PacketEvents(header=links.header)
            events.events = [kinds(kind=kinds.SENT, receiver=-1, **common),
                             kinds(kind=kinds.DROPPED, receiver=2, reason=clash, **common)]
            self.packets.publish(events)


class Markers(unittest.TestCase):
    """The view shows what was published."""

    @classmethod
    def setUpClass(cls):
        cls.arrays = {"overview": None, "close": None}
        cls.condition = threading.Condition()

        def listen(view):
            def on_array(message):
                with cls.condition:
                    cls.arrays[view] = message.markers
                    cls.condition.notify_all()

            kind = visualization_msgs.msg.MarkerArray
            return rospy.Subscriber(f"/markers/{view}", kind, on_array)

        cls.subscribers = [listen(view) for view in cls.arrays]
        cls.diagnostics = Diagnostics()
        cls.run_under_test = Run()
        cls.step = 0

    def shown(self, view, namespace):
        """Returns the markers that are shown in a namespace of the newest array."""
        markers = self.arrays[view] or []
        return [m for m in markers if m.ns == namespace and m.action == Marker.ADD]

    def publish_until(self, predicate, what, **content):
        """Publishes steps until `predicate` holds."""
        deadline = rospy.get_time() + 15.0
        while rospy.get_time() < deadline:
            Markers.step += 1
            self.run_under_test.publish(self.step, **content)
            with self.condition:
                if self.condition.wait_for(predicate, 0.2):
                    return
        self.fail(f"never seen: {what}")

    def test_every_auv_has_a_hull_in_the_colour_of_its_phase(self):
        count = synthetic_bag.AGENTS
        self.publish_until(lambda: len(self.shown("overview", "hull")) == count, "hulls")
        # Grey, for an AUV without a report, is a colour, too. Only the labels show that all have reported.
        words = ("search", "approach", "stable", "lost", "leads")

        def labelled():
            labels = " ".join(m.text for m in self.shown("overview", "label"))
            return all(word in labels for word in words)

        self.publish_until(labelled, f"labels with {words}")
        self.publish_until(
            lambda: len({(m.color.r, m.color.g) for m in self.shown("close", "hull")}) == count,
            "four colours for four phases",
        )

    def test_lost_packets_appear_with_their_reason_and_go(self):
        self.publish_until(lambda: self.shown("overview", "hull"), "a hull")
        self.publish_until(lambda: self.shown("overview", "link"), "links")
        self.publish_until(
            lambda: self.shown("overview", "lost_packet"), "a lost packet", dropped=self.step + 1
        )
        lost = self.step
        reasons = {m.text for m in self.shown("overview", "lost_reason")}
        self.assertEqual(reasons, {"range"})
        self.publish_until(
            lambda: not self.shown("overview", "lost_packet"), "no lost packet", dropped=lost
        )

    def test_what_disturbs_a_modem_is_shown_where_it_is(self):
        # The name makes it run last: after packets have been reported, their counts are no longer used.
        self.publish_until(lambda: self.shown("overview", "hull"), "a hull")
        reasons = auv_msgs.msg.LinkState
        for name, reason in (("collision", reasons.COLLISION), ("half_duplex", reasons.HALF_DUPLEX)):
            self.publish_until(lambda name=name: self.shown("overview", name), name, clash=reason)
            (ball,) = self.shown("overview", name)
            self.assertEqual(ball.id, 2)
            here = synthetic_bag.auv_at(2, self.step * synthetic_bag.STEP_S)
            place = ball.pose.position
            self.assertLess(math.dist((place.x, place.y, place.z), here), 0.1)
            # There are two rings around AUV 1, and none around the others.
            self.assertEqual({m.id for m in self.shown("overview", "carrier")}, {2, 3})
        self.publish_until(lambda: not self.shown("overview", "half_duplex")
                           and not self.shown("overview", "carrier"), "silence again")

    def test_the_past_stays_when_an_auv_is_some_steps_behind(self):
        self.publish_until(lambda: self.step > 20 and self.shown("overview", "link"), "links")
        late = rospy.Time(1, 0) + rospy.Duration.from_sec((self.step - 15) * synthetic_bag.STEP_S)
        self.run_under_test.odom[1].publish(
            synthetic_bag.odometry("auv_1/base_link", late, (0.0, 0.0, 0.0), (1, 0)))
        for _ in range(10):  # views
            with self.condition:
                self.condition.wait(5.0)
        self.assertTrue(self.shown("overview", "link"))

    def test_open_water_shows_ring_assignment_and_stations(self):
        def points(namespace, vehicle):
            (line,) = [m for m in self.shown("overview", namespace) if m.id == vehicle]
            return [(p.x, p.y, p.z) for p in line.points]

        run = self.run_under_test
        second = rospy.Publisher("/target_1/odom", nav_msgs.msg.Odometry, queue_size=10, latch=True)
        stations = [rospy.Publisher(f"/station_{k}/odom", nav_msgs.msg.Odometry, queue_size=10, latch=True)
                    for k in range(2)]  # fmt: skip
        places = [(0.5, -0.25, -0.75), (-0.5, 0.125, 0.0)]
        for k, (station, place) in enumerate(zip(stations, places)):
            station.publish(synthetic_bag.odometry(f"station_{k}", rospy.Time(1, 0), place, (0, 0)))
        self.publish_until(lambda: not self.shown("overview", "ring"), "no ring in a box")
        text = synthetic_bag.SCENARIO.replace("1.0}", "2.0}") + "sea: {open: true}\n"
        text += "task: {desired_distance_m: 0.25}\ntrack: {lost_std_m: 0.5}\n"
        second.publish(synthetic_bag.odometry("target_1", rospy.Time(1, 0), (1.5, 1.5, 0.0), (1, 0)))
        try:
            # A list of craft alone, as in a scenario without beacons, and one of both.
            for listed, words in (("crafts: [[0, 0], [1, 1]]", {"craft 0", "craft 1"}),
                                  ("beacons: [[0, 0, 0]], crafts: [[0, 0]]", {"beacon 0", "craft 1"})):
                run.scenario.publish(text + "stations: {" + listed + "}\n")
                self.publish_until(
                    lambda words=words: {m.text for m in self.shown("overview", "station_label")} == words, words)
                self.publish_until(lambda: len(self.shown("overview", "ring")) == synthetic_bag.AGENTS, "rings")
            for station, place in zip(sorted(self.shown("overview", "station"), key=lambda m: m.id), places):
                p = station.pose.position
                self.assertEqual((p.x, p.y, p.z), place)
            self.publish_until(lambda: len(self.shown("overview", "follows")) == synthetic_bag.AGENTS, "lines")
            for i in range(synthetic_bag.AGENTS):
                (estimate,) = [m.pose.position for m in self.shown("overview", "estimate") if m.id == i]
                centre = (estimate.x, estimate.y, estimate.z)
                for p in points("ring", i):
                    self.assertAlmostEqual(math.dist(p, centre), 0.25)
                    self.assertAlmostEqual(p[2], centre[2])
                (hull,) = [m.pose.position for m in self.shown("overview", "hull") if m.id == i]
                line = points("follows", i)
                self.assertLess(math.dist(line[0], (hull.x, hull.y, hull.z)), 1e-9)
                self.assertLess(math.dist(line[-1], centre), 1e-9)
            # An estimate that is too uncertain has no ring.
            run.scenario.publish(text.replace("lost_std_m: 0.5", "lost_std_m: 1.0e-6"))
            self.publish_until(lambda: not self.shown("overview", "ring"), "no ring")
        finally:
            run.scenario.publish(synthetic_bag.SCENARIO.replace("1.0}", "2.0}"))

    def test_walls_follow_the_scenario(self):
        def walls():
            points = [p for m in self.shown("overview", "workspace") for p in m.points]
            return points and abs(max(p.x for p in points) - 2.0) < 1e-9

        self.publish_until(walls, "walls at 2 m")

    def test_a_position_that_is_no_number_is_never_shown(self):
        self.publish_until(lambda: self.shown("close", "hull"), "a hull")
        for _ in range(10):
            Markers.step += 1
            self.run_under_test.publish(self.step, position=(math.nan, 0.0, 0.0))
            rospy.sleep(0.05)
        for view in self.arrays:
            for marker in self.arrays[view]:
                for p in [marker.pose.position, *marker.points]:
                    self.assertTrue(math.isfinite(p.x + p.y + p.z), marker.ns)
        wait_for(lambda: self.diagnostics.value("markers", "refused odom: not finite"), 10.0,
                 "refused odometry in the diagnostics")
        wait_for(lambda: self.diagnostics.value("markers", "AUVs seen") == synthetic_bag.AGENTS,
                 40.0, "all AUVs in the diagnostics")

    def test_no_marker_is_one_that_rviz_complains_about(self):
        self.publish_until(lambda: self.shown("close", "hull"), "a hull")
        for view, markers in self.arrays.items():
            self.assertEqual(len({(m.ns, m.id) for m in markers}), len(markers), view)
            for m in markers:
                if m.action != Marker.ADD:
                    continue
                self.assertEqual(m.header.frame_id, "world")
                q = m.pose.orientation
                self.assertAlmostEqual(q.x**2 + q.y**2 + q.z**2 + q.w**2, 1.0, delta=1e-3)
                self.assertGreater(m.color.a if not m.colors else 1.0, 0.0, m.ns)
                self.assertGreater(max(m.scale.x, m.scale.z), 0.0, m.ns)
                if m.type in LISTS:
                    self.assertGreaterEqual(len(m.points), 1 if m.type == Marker.SPHERE_LIST else 2)
                    self.assertIn(len(m.colors), (0, len(m.points)), m.ns)
                if m.type == Marker.TEXT_VIEW_FACING:
                    self.assertTrue(m.text.strip(), m.ns)


if __name__ == "__main__":
    rospy.init_node("markers_test")
    rostest.rosrun("stg_bringup", "markers_test", Markers)
