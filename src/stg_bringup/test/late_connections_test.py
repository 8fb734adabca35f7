#!/usr/bin/python3
"""A node does the same, whichever of its topics connects first. It loses nothing at the start."""

import unittest

import rosgraph
import rosnode
import rospy
import rostest
from auv_msgs.msg import AcousticReception, ActuatorCommand, SensorFrame, SwarmState
from geometry_msgs.msg import Pose, TwistStamped, Vector3
from graph_listener import Latest, wait_for
from nav_msgs.msg import Odometry

AGENTS = 4
PART_S, PARTS = 0.2, 5  # periods of the autopilot in one decision
BRIEF_S = 1.0  # on the wall clock: longer than the agent's patience, shorter than its patience at the start


def stamp_of(seconds):
    return rospy.Time.from_sec(round(seconds, 9))


def frame_of(auv, run, seconds):
    """Returns step 0 of a run that begins at `seconds`."""
    frame = SensorFrame(run=run, episode=0, step=0, seed=1)
    frame.header.stamp, frame.header.frame_id = stamp_of(seconds), f"auv_{auv}/base_link"
    frame.pose.position.z, frame.pose.orientation.w = -5.0, 1.0
    return frame


def hears(node, topic):
    """Tells whether a node has a connection to a publisher of a topic, or looks for one."""
    uri = rosgraph.Master("/stg_test").lookupNode(node)
    connections = rosnode.ServerProxy(uri).getBusInfo("/stg_test")[2]
    return any(way == "i" and name == topic for _, _, way, _, name, *_ in connections)


class Controller:
    """The controller of AUV 0, and the steps that the test gives to it."""

    def __init__(self):
        self.actuators = Latest("/auv_0/actuators", ActuatorCommand)
        self.odometry, self.velocity = (
            rospy.Publisher(f"/auv_0/{name}", kind, queue_size=10, latch=True)
            for name, kind in (("odom", Odometry), ("cmd_vel", TwistStamped)))
        for publisher in (self.odometry, self.velocity):
            wait_for(lambda p=publisher: p.get_num_connections() > 0, 20.0, publisher.name)

    def command(self, seconds):
        message = TwistStamped()
        message.header.stamp, message.header.frame_id = stamp_of(seconds), "world"
        message.twist.linear.x, message.twist.linear.y, message.twist.linear.z = 1.0, 1.0, -0.1
        self.velocity.publish(message)

    def move(self, seconds):
        message = Odometry(child_frame_id="auv_0/base_link")
        message.header.stamp, message.header.frame_id = stamp_of(seconds), "world"
        message.pose.pose.orientation.w = 1.0
        message.pose.pose.position.z, message.twist.twist.linear.x = -5.0, 1.0
        self.odometry.publish(message)

    def answer(self, seconds):
        """Returns the actuators' values for the odometry of a time."""
        stamp = stamp_of(seconds)
        wait_for(lambda: self.actuators.message and self.actuators.message.header.stamp == stamp,
                 10.0, f"actuators of {seconds}")
        return list(self.actuators.message.values)

    def parts(self, start):
        """Returns the answers between the first decision of a run and the second."""
        values = []
        for part in range(1, PARTS):
            self.move(start + part * PART_S)
            values.append(self.answer(start + part * PART_S))
        return values


class LateConnections(unittest.TestCase):
    def test_an_autopilot_begins_with_the_episode_whenever_that_is_announced(self):
        """Its memory is the same as in the usual order, in which the frame comes first."""
        controller = Controller()
        controller.command(1.0)
        controller.move(1.0)
        first = controller.answer(1.0)  # nothing sends frames yet
        frames = rospy.Publisher("/auv_0/sensor_frame", SensorFrame, queue_size=10, latch=True)
        frames.publish(frame_of(0, 1, 1.0))
        wait_for(lambda: frames.get_num_connections() > 0, 20.0, "the controller's frames")
        rospy.rostime.wallsleep(0.5)
        late = [first, *controller.parts(1.0)]

        frames.publish(frame_of(0, 1, 101.0))
        rospy.rostime.wallsleep(0.5)
        controller.move(101.0)
        controller.command(101.0)
        usual = [controller.answer(101.0), *controller.parts(101.0)]
        self.assertNotEqual(usual[0], usual[-1], "an autopilot without memory shows nothing")
        self.assertEqual(late, usual)

        # The clock goes back, and no node sends frames. The controller knows the new run by its odometry
        # alone. The velocity that answers the odometry may come before it.
        self.assertTrue(hears("/auv_0/controller", "/auv_0/sensor_frame"))
        frames.unregister()
        wait_for(lambda: not hears("/auv_0/controller", "/auv_0/sensor_frame"), 20.0,
                 "the controller knows that nothing sends frames")
        controller.command(11.0)
        rospy.rostime.wallsleep(0.5)
        controller.move(11.0)
        again = [controller.answer(11.0), *controller.parts(11.0)]
        self.assertEqual(again, usual)

    def test_an_agent_begins_when_its_modem_is_connected(self):
        """A window that is sent earlier would be lost with its packets."""
        commands = Latest("/auv_1/cmd_vel", TwistStamped)
        frames = rospy.Publisher("/auv_1/sensor_frame", SensorFrame, queue_size=10, latch=True)
        frames.publish(frame_of(1, 1, 1.0))
        wait_for(lambda: frames.get_num_connections() > 0, 20.0, "the agent's frames")
        rospy.rostime.wallsleep(BRIEF_S)
        self.assertEqual(commands.count, 0)
        modem = rospy.Publisher("/auv_1/acoustic/rx", AcousticReception, queue_size=10, latch=True)
        greeting = AcousticReception()
        greeting.header.stamp, greeting.header.frame_id = stamp_of(1.0), "auv_1/base_link"
        modem.publish(greeting)
        self.assertEqual(commands.wait(3.0).header.stamp, stamp_of(1.0))

    def test_the_channel_greets_before_anybody_has_transmitted(self):
        receptions = Latest("/auv_2/acoustic/rx", AcousticReception)
        swarm = rospy.Publisher("/swarm_state", SwarmState, queue_size=10, latch=True)
        state = SwarmState(run=1, episode=0, step=0, seed=1,
                           poses=[Pose() for _ in range(AGENTS)],
                           velocities=[Vector3() for _ in range(AGENTS)])
        state.header.stamp, state.header.frame_id = stamp_of(1.0), "world"
        for k, pose in enumerate(state.poses):
            pose.position.x, pose.position.z, pose.orientation.w = 100.0 * k, -5.0, 1.0
        swarm.publish(state)
        greeting = receptions.wait(10.0)
        self.assertEqual(greeting.header.stamp, stamp_of(1.0))
        self.assertEqual(greeting.packets, [])


if __name__ == "__main__":
    rospy.init_node("late_connections")
    rostest.rosrun("stg_bringup", "late_connections", LateConnections)
