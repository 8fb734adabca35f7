#!/usr/bin/python3
"""Every command meets its odometry, whichever of them comes first and however early it comes."""

import unittest

import rospy
import rostest
from auv_msgs.msg import ActuatorCommand, SensorFrame
from geometry_msgs.msg import TwistStamped, WrenchStamped
from graph_listener import wait_for
from nav_msgs.msg import Odometry


class Controller(unittest.TestCase):
    """This test plays the world and the agent for one controller."""

    @classmethod
    def setUpClass(cls):
        cls.torpedo = rospy.get_param("~vehicle") == "torpedo"
        cls.period = 1.0 if cls.torpedo else 0.1
        cls.answers = []
        answer = ("/auv_0/actuators", ActuatorCommand) if cls.torpedo else (
            "/auv_0/wrench", WrenchStamped)
        cls.listener = rospy.Subscriber(*answer, cls.answers.append)
        cls.commands = rospy.Publisher("/auv_0/cmd_vel", TwistStamped, queue_size=10)
        cls.odometry = rospy.Publisher("/auv_0/odom", Odometry, queue_size=10)
        cls.frames = rospy.Publisher("/auv_0/sensor_frame", SensorFrame, queue_size=10)
        heard = [cls.commands, cls.odometry] + [cls.frames] * cls.torpedo
        wait_for(lambda: all(p.get_num_connections() > 0 for p in heard)
                 and cls.listener.get_num_connections() > 0, 20.0, "the controller")

    def stamp(self, step):
        """Returns the stamp of a step, in whole milliseconds."""
        return rospy.Time.from_sec(round(100.0 + step * self.period, 3))

    def command(self, step, speed=0.1):
        """Sends the velocity for a step."""
        message = TwistStamped()
        message.header.stamp = self.stamp(step)
        message.header.frame_id = "world"
        message.twist.linear.x = speed
        self.commands.publish(message)

    def navigate(self, step, episode_step=None):
        """Sends the odometry of a step. For a torpedo it sends the sensor frame first, if there is one."""
        if self.torpedo and episode_step is not None:
            self.frame(step, episode_step)
        message = Odometry()
        message.header.stamp = self.stamp(step)
        message.header.frame_id = "world"
        message.child_frame_id = "auv_0/base_link"
        message.pose.pose.orientation.w = 1.0
        message.twist.twist.linear.x = 1.0
        self.odometry.publish(message)

    def frame(self, step, episode_step):
        """Sends the sensor frame of a step."""
        message = SensorFrame(step=episode_step)
        message.header.stamp = self.stamp(step)
        message.header.frame_id = "auv_0/base_link"
        message.pose.orientation.w = 1.0
        self.frames.publish(message)

    def answered(self, steps):
        """Tells whether exactly these steps have been answered, in this order."""
        return [m.header.stamp for m in self.answers] == [self.stamp(k) for k in steps]

    def test_1_commands_that_are_two_steps_ahead_are_all_answered(self):
        self.command(0)
        self.navigate(0, 0)
        wait_for(lambda: self.answered([0]), 10.0, "the first step")
        self.command(1)
        self.command(2)
        rospy.sleep(0.5)  # they come before the odometry, on another connection
        self.navigate(1, 1)
        rospy.sleep(0.2)
        self.navigate(2, 2)
        wait_for(lambda: self.answered([0, 1, 2]), 10.0, "one answer for each step")

    def test_2_an_episode_begins_with_its_own_odometry(self):
        if not self.torpedo:
            return
        steer = {}
        for begin in (20, 40):
            # The frame of the new episode comes before the last odometry of the old one.
            del self.answers[:]
            for k in range(5 if begin == 40 else 2):
                self.navigate(begin - 8 + k, 3 + k)
                self.command(begin - 8 + k, 2.0)
                wait_for(lambda k=k: len(self.answers) > k, 10.0, "an answer")
            self.frame(begin, 0)
            rospy.sleep(0.3)
            if begin == 40:
                answers = len(self.answers)
                self.navigate(begin - 3.6)  # the command of the step before answers it
                wait_for(lambda: len(self.answers) > answers, 10.0, "an answer between decisions")
            self.navigate(begin)
            self.command(begin)
            wait_for(lambda: self.answers[-1].header.stamp == self.stamp(begin), 10.0, "the answer")
            steer[begin] = self.answers[-1].values
        self.assertEqual(steer[20], steer[40], "nothing of the episode before is left")


if __name__ == "__main__":
    rospy.init_node("controller_test")
    rostest.rosrun("stg_bringup", "controller", Controller)
