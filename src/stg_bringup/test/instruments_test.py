#!/usr/bin/env python3
"""The AUVs' instruments say the same as the world, in their own terms."""

import math
import unittest

import rospy
import rostest
import tf2_ros
from auv_msgs.msg import SensorFrame
from geometry_msgs.msg import TwistWithCovarianceStamped
from sensor_msgs.msg import FluidPressure, Imu, NavSatFix, Range

TYPES = {
    "sensor_frame": SensorFrame,
    "imu": Imu,
    "pressure": FluidPressure,
    "dvl": TwistWithCovarianceStamped,
    "altitude": Range,
    "gps": NavSatFix,
}
BOTTOM_M = 101.0  # depth of the flat bottom
STEPS = 60


def rotate_back(q, v):
    """R(q)^T v of a unit quaternion."""
    w, x, y, z = q.w, -q.x, -q.y, -q.z
    tx, ty, tz = (2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0]))
    return (
        v[0] + w * tx + y * tz - z * ty,
        v[1] + w * ty + z * tx - x * tz,
        v[2] + w * tz + x * ty - y * tx,
    )


class Instruments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.heard = {topic: {} for topic in TYPES}
        cls.tree = tf2_ros.Buffer(rospy.Duration(3600))
        cls.listener = tf2_ros.TransformListener(cls.tree)
        for topic, kind in TYPES.items():
            rospy.Subscriber("/auv_1/" + topic, kind, cls.keep(topic))
        end = rospy.get_time() + 40.0
        while len(cls.heard["sensor_frame"]) < STEPS and rospy.get_time() < end:
            rospy.rostime.wallsleep(0.1)
        rospy.rostime.wallsleep(0.5)

    @classmethod
    def keep(cls, topic):
        return lambda message: cls.heard[topic].setdefault(message.header.stamp.to_nsec(), message)

    def pairs(self, topic):
        frames = self.heard["sensor_frame"]
        found = [(frames[t], m) for t, m in sorted(self.heard[topic].items()) if t in frames]
        self.assertGreater(len(found), 20 if topic != "gps" else 0, topic)
        own = "auv_1/altimeter" if topic == "altitude" else found[0][0].header.frame_id
        for _, message in found:
            self.assertEqual(message.header.frame_id, own)
        return found

    def test_pressure_is_that_of_the_water_above(self):
        deepest = 0.0
        for frame, message in self.pairs("pressure"):
            depth = -frame.pose.position.z
            deepest = max(deepest, depth)
            self.assertAlmostEqual(message.fluid_pressure, 101325.0 + 1026.0 * 9.81 * depth, 3)
        self.assertGreater(deepest, 1.0, "the AUV did not dive")

    def test_altitude_and_depth_add_up_to_the_depth_of_the_bottom(self):
        beyond = 0
        for frame, message in self.pairs("altitude"):
            altitude = BOTTOM_M + frame.pose.position.z
            if altitude <= message.max_range:
                self.assertAlmostEqual(message.range, altitude, 4)
            else:
                self.assertEqual(message.range, math.inf)
                beyond += 1
        self.assertGreater(beyond, 0)

    def test_the_beam_of_the_altimeter_ends_at_the_bottom_below_the_auv(self):
        ranges = [(f, m) for f, m in self.pairs("altitude") if m.range <= m.max_range]
        self.assertGreater(len(ranges), 0)
        for frame, message in ranges:
            beam = self.tree.lookup_transform(
                "world", message.header.frame_id, message.header.stamp, rospy.Duration(5)
            ).transform
            q = beam.rotation
            back = type(q)(w=q.w, x=-q.x, y=-q.y, z=-q.z)
            end = rotate_back(back, (message.range, 0.0, 0.0))
            self.assertAlmostEqual(beam.translation.z + end[2], -BOTTOM_M, 3)
            self.assertAlmostEqual(beam.translation.x + end[0], frame.pose.position.x, 3)
            self.assertAlmostEqual(beam.translation.y + end[1], frame.pose.position.y, 3)

    def test_dvl_and_imu_move_as_the_navigation_says(self):
        for frame, message in self.pairs("dvl"):
            self.assertEqual(message.twist.twist.linear, frame.twist.linear)
        for frame, message in self.pairs("imu"):
            self.assertEqual(message.orientation, frame.pose.orientation)
            self.assertEqual(message.angular_velocity, frame.twist.angular)

    def test_at_rest_the_imu_feels_gravity_alone(self):
        frame, message = next(p for p in self.pairs("imu") if p[0].step == 0)
        want = rotate_back(frame.pose.orientation, (0.0, 0.0, 9.81))
        got = message.linear_acceleration
        for a, b in zip(want, (got.x, got.y, got.z)):
            self.assertAlmostEqual(a, b, 9)

    def test_gps_is_heard_at_the_surface_alone_and_knows_the_datum(self):
        metres_a_degree = 111_320.0
        for frame, message in self.pairs("gps"):
            self.assertGreaterEqual(frame.pose.position.z, -0.5)
            east = (message.longitude - 10.25) * metres_a_degree * math.cos(math.radians(54.5))
            north = (message.latitude - 54.5) * metres_a_degree
            # A sphere has an error of up to half a percent over some hundred metres.
            self.assertAlmostEqual(east, frame.pose.position.x, delta=6.0)
            self.assertAlmostEqual(north, frame.pose.position.y, delta=6.0)
        deep = [f for f in self.heard["sensor_frame"].values() if f.pose.position.z < -0.5]
        self.assertTrue(deep)
        for frame in deep:
            self.assertNotIn(frame.header.stamp.to_nsec(), self.heard["gps"])


if __name__ == "__main__":
    rospy.init_node("instruments")
    rostest.rosrun("stg_bringup", "instruments", Instruments)
