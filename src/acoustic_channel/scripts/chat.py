#!/usr/bin/python3
"""Two scripted vehicles that chat. Needs: roslaunch acoustic_channel channel.launch vehicles:="[alpha, beta]"."""

import argparse

import rospy
from auv_msgs.msg import AcousticPacket, AcousticReception, TransmitStatus
from nav_msgs.msg import Odometry


class Vehicle:
    """Reports its position, answers every question, and reports the fate of its packets."""

    def __init__(self, name, x):
        self.name, self.x, self.number = name, x, 0
        self.odom = rospy.Publisher(f"/{name}/odom", Odometry, queue_size=10)
        self.tx = rospy.Publisher(f"/{name}/acoustic/tx", AcousticPacket, queue_size=10)
        rospy.Subscriber(f"/{name}/acoustic/rx", AcousticReception, self.hear)
        rospy.Subscriber(f"/{name}/acoustic/status", TransmitStatus, self.watch)
        rospy.Timer(rospy.Duration(0.1), self.move)

    def move(self, _):
        odom = Odometry()
        odom.header.stamp, odom.header.frame_id = rospy.Time.now(), "world"
        odom.pose.pose.position.x, odom.pose.pose.orientation.w = self.x, 1.0
        self.odom.publish(odom)

    def say(self, text, destination=-1):
        self.number += 1
        self.tx.publish(destination=destination, sequence=self.number, data=text.encode())

    def hear(self, reception):
        for packet in reception.packets:
            text = packet.data.decode()
            rospy.loginfo("%s hears %d after %.3f s: %s", self.name, packet.source, packet.travel_time, text)
            if text.endswith("?"):
                self.say(f"{self.name} is {self.x} m east", packet.source)

    def watch(self, status):
        rospy.loginfo("%s, packet %d: %s", self.name, status.sequence, status.text)


argparse.ArgumentParser(description=__doc__).parse_args(rospy.myargv()[1:])
rospy.init_node("chat")
alpha, beta = Vehicle("alpha", 0.0), Vehicle("beta", 600.0)
rospy.Timer(rospy.Duration(5.0), lambda _: alpha.say("where are you?"))
rospy.spin()
