#!/usr/bin/python3
"""The channel alone: three vehicles of no project, whose modems disturb each other."""

import math
import unittest

import rospy
import rostest
from auv_msgs.msg import LinkState, LinkStates, PacketEvent, PacketEvents, TransmitStatus
from auv_msgs.srv import Ping


from fleet_world import Diagnostics, Vehicle, World, wait_for

SOUND_SPEED = 1500.0


class Fleet(unittest.TestCase):
    """Each test leaves the fleet as it was before."""

    @classmethod
    def setUpClass(cls):
        cls.alpha = Vehicle("alpha", 10, (0.0, 0.0, -20.0))
        cls.beta = Vehicle("beta", 20, (300.0, 400.0, -20.0))
        cls.gamma = Vehicle("gamma", 30, (0.0, 700.0, -20.0))
        cls.events, cls.links = [], []
        cls.subscribers = [
            rospy.Subscriber("/acoustic_channel/packets", PacketEvents,
                             lambda m: cls.events.extend(m.events)),
            rospy.Subscriber("/acoustic_channel/links", LinkStates, cls.links.append)]
        cls.diagnostics = Diagnostics()
        cls.world = World([cls.alpha, cls.beta, cls.gamma])
        wait_for(lambda: cls.diagnostics.values.get("gamma") == "here", 30.0, "gamma is here")

    def say_until_heard(self, sender, receiver, data, **address):
        """Repeats a packet, as one does in noise, until the receiver hears it; returns the packet."""
        def heard():
            sender.say(data, **address)
            self.world.pass_time(2.0)
            return receiver.heard(data)

        return wait_for(heard, 60.0, f"{receiver.name} hears {data}")[0]

    def test_everybody_hears_any_bytes_with_their_source_and_travel_time(self):
        data = bytes((0, 255, 10, 13, 128, 7))
        packet = self.say_until_heard(self.alpha, self.beta, data)
        self.assertEqual((packet.source, packet.destination), (10, -1))
        self.assertAlmostEqual(packet.travel_time, 500.0 / SOUND_SPEED, delta=0.01)
        self.assertGreater(packet.arrival, packet.transmit)
        self.assertGreater(packet.received_level_db, packet.noise_level_db)
        self.assertTrue(math.isfinite(packet.sinr_db))
        wait_for(lambda: self.gamma.heard(data), 20.0, "gamma hears it, too")

    def test_a_packet_for_one_is_heard_by_no_other(self):
        packet = self.say_until_heard(self.alpha, self.gamma, b"for gamma", destination=30)
        self.assertEqual(packet.destination, 30)
        self.world.pass_time(2.0)
        self.assertFalse(self.beta.heard(b"for gamma"))

    def test_the_modem_says_what_becomes_of_each_packet(self):
        # The first packet leaves, the last one waits for its end, and the others are replaced.
        start = self.world.now() + rospy.Duration(1)
        numbers = [self.alpha.say(b"word %d" % k, stamp=start + rospy.Duration(0.05 * k))
                   for k in range(4)]
        queued, sent, dropped = (TransmitStatus.QUEUED, TransmitStatus.SENT, TransmitStatus.DROPPED)
        wait_for(lambda: all(len(self.alpha.fate(n)) == 2 for n in numbers), 20.0, "statuses")
        self.assertEqual([[s.status for s in self.alpha.fate(n)] for n in numbers],
                         [[queued, sent], [queued, dropped], [queued, dropped], [queued, sent]])
        first, last = (self.alpha.fate(n)[1] for n in (numbers[0], numbers[3]))
        self.assertGreater(first.airtime, 0.1)
        self.assertEqual(first.modem_sequence + 1, last.modem_sequence)
        self.assertGreaterEqual(last.transmit.to_sec(), first.transmit.to_sec() + first.airtime)
        self.assertEqual(self.alpha.fate(numbers[1])[1].reason, LinkState.QUEUE)

    def test_who_speaks_at_one_time_hears_nobody(self):
        stamp = self.world.now() + rospy.Duration(0.5)
        self.alpha.say(b"a" * 32, stamp=stamp)
        # The sound takes half a second and travels for a third of a second.
        self.beta.say(b"b" * 32, stamp=stamp)

        def deaf():
            return {(e.source, e.receiver) for e in self.events if e.kind == PacketEvent.DROPPED
                    and e.reason == LinkState.HALF_DUPLEX and e.bytes == 32}

        wait_for(lambda: deaf() >= {(10, 20), (20, 10)}, 20.0, "half-duplex losses of both")

    def test_a_ping_measures_the_range(self):
        ping = rospy.ServiceProxy("/acoustic_channel/ping", Ping)

        def answered():
            answer = ping(source=10, destination=20, timeout=5.0)
            return answer if answer.success else None

        answer = wait_for(answered, 60.0, "an answer")
        self.assertAlmostEqual(answer.range, 500.0, delta=1.0)
        self.assertAlmostEqual(answer.round_trip, 2.0 * 500.0 / SOUND_SPEED, delta=0.02)
        # The vehicle itself, a vehicle that is not in the list, and one that never said where it is.
        for source, destination in ((10, 10), (10, 7), (0, 20), (10, 40)):
            refused = ping(source=source, destination=destination, timeout=5.0)
            self.assertFalse(refused.success)
            self.assertTrue(refused.message)

    def test_who_never_said_where_it_is_is_named_and_the_rest_goes_on(self):
        wait_for(lambda: "no odometry on /delta/odom" in self.diagnostics.message, 20.0,
                 "delta in the diagnostics")
        self.assertEqual(self.diagnostics.values["delta"], "no odometry yet")
        self.say_until_heard(self.alpha, self.beta, b"without delta")

    def test_links_of_all_pairs_by_id(self):
        wait_for(lambda: self.links and len(self.links[-1].links) == 6, 20.0, "six links")
        links = {(l.source, l.destination): l for l in self.links[-1].links}
        self.assertAlmostEqual(links[10, 20].distance, 500.0, delta=0.01)
        self.assertAlmostEqual(links[30, 10].distance, 700.0, delta=0.01)
        self.assertAlmostEqual(links[30, 10].delay, 700.0 / SOUND_SPEED, delta=0.02)

    def test_who_is_silent_is_left_out_and_comes_back(self):
        self.gamma.silent = True
        try:
            wait_for(lambda: self.diagnostics.values.get("gamma") == "silent", 20.0, "the silence")
            self.assertEqual(self.diagnostics.level, 1)
            self.assertIn("gamma is silent", self.diagnostics.message)
            number = self.gamma.say(b"can you hear me?")
            refusal = wait_for(lambda: self.gamma.fate(number), 20.0, "a status")[0]
            self.assertEqual(refusal.status, TransmitStatus.REFUSED)
            self.assertIn("no odometry", refusal.text)
            ping = rospy.ServiceProxy("/acoustic_channel/ping", Ping)
            for pair in ((10, 30), (30, 10)):
                self.assertFalse(ping(source=pair[0], destination=pair[1], timeout=2.0).success)
            self.say_until_heard(self.alpha, self.beta, b"without gamma")
            self.assertFalse(self.gamma.heard(b"without gamma"))
        finally:
            self.gamma.silent = False
        wait_for(lambda: self.diagnostics.values.get("gamma") == "here", 20.0, "the return")
        self.say_until_heard(self.alpha, self.gamma, b"welcome back")

    def test_packets_that_no_modem_takes_are_refused_and_the_rest_goes_on(self):
        before = self.diagnostics.number("refused acoustic/tx: malformed")
        late = self.diagnostics.number("refused acoustic/tx: stale")
        year = rospy.Duration(365 * 86400)
        for what, text, packet in (
                ("too long", "bytes of payload", {"data": b"x" * 5000}),
                ("empty", "bytes of payload", {"data": b""}),
                ("unknown destination", "7 does not exist", {"data": b"x", "destination": 7}),
                ("for itself", "destination", {"data": b"x", "destination": 10}),
                ("far future", "the clock is at", {"data": b"x", "stamp": self.world.now() + year}),
                ("far past", "the clock is at", {"data": b"x", "stamp": rospy.Time(1)})):
            with self.subTest(what):
                number = self.alpha.say(**packet)
                (refusal,) = wait_for(lambda number=number: self.alpha.fate(number), 20.0, what)
                self.assertEqual(refusal.status, TransmitStatus.REFUSED)
                self.assertIn(text, refusal.text)
        wait_for(lambda: self.diagnostics.number("refused acoustic/tx: malformed") == before + 4
                 and self.diagnostics.number("refused acoustic/tx: stale") == late + 2,
                 20.0, "refusals in the diagnostics")
        self.say_until_heard(self.alpha, self.beta, b"still here")

    def test_odometry_that_cannot_be_is_refused_and_the_rest_goes_on(self):
        def spoilt(what):
            message = self.beta.odometry(self.world.now())
            if what == "nan":
                message.pose.pose.position.y = math.nan
            elif what == "huge":
                message.twist.twist.linear.x = 1e200
            elif what == "not a rotation":
                message.pose.pose.orientation.w = 0.0
            else:
                message.header.stamp += rospy.Duration(1e6)
            return message

        for what, reason in (("nan", "not finite"), ("huge", "not finite"),
                             ("not a rotation", "not finite"), ("future", "stale")):
            with self.subTest(what):
                key = f"refused odom: {reason}"
                before = self.diagnostics.number(key)
                self.beta.odom.publish(spoilt(what))
                wait_for(lambda key=key, before=before: self.diagnostics.number(key) == before + 1,
                         20.0, what)
                self.assertIn("/beta/odom", self.diagnostics.values["last refusal"])
        link = self.links[-1].links[0]
        self.assertAlmostEqual(link.distance, 500.0, delta=0.01)
        self.say_until_heard(self.alpha, self.beta, b"where beta is")

    def test_a_clock_that_goes_back_begins_a_new_run(self):
        runs = self.diagnostics.number("runs")
        self.world.leap(-100.0)
        wait_for(lambda: self.diagnostics.number("runs") == runs + 1, 20.0, "another run")
        self.say_until_heard(self.alpha, self.beta, b"once more")


if __name__ == "__main__":
    rospy.init_node("fleet_test")
    rostest.rosrun("acoustic_channel", "fleet", Fleet)
