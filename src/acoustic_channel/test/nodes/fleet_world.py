"""Shared by the tests of the channel alone: a clock, vehicles that use it, and waiting."""

import contextlib
import threading
import time

import rospy
from auv_msgs.msg import AcousticPacket, AcousticReception, TransmitStatus
from diagnostic_msgs.msg import DiagnosticArray
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock


from stg_common.waiting import wait_for


class Diagnostics:
    """The newest diagnostic values of the channel."""

    def __init__(self):
        self.level, self.message, self.values = 0, "", {}
        self._subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, self._keep)

    def _keep(self, array):
        for status in array.status:
            if status.name.startswith("acoustic_channel"):
                self.values = {pair.key: pair.value for pair in status.values}
                self.level, self.message = status.level, status.message

    def number(self, key):
        """Returns a count, or 0 if there is none yet."""
        return float(self.values.get(key, 0))


class Vehicle:
    """Stays at `position` and keeps what its modem says."""

    def __init__(self, name, number, position):
        self.name, self.number, self.position, self.silent = name, number, position, False
        self.received, self.status, self.said = [], [], 0
        self.odom = rospy.Publisher(f"/{name}/odom", Odometry, queue_size=100)
        self.tx = rospy.Publisher(f"/{name}/acoustic/tx", AcousticPacket, queue_size=100)
        self._subscribers = [
            rospy.Subscriber(f"/{name}/acoustic/rx", AcousticReception,
                             lambda m: self.received.extend(m.packets)),
            rospy.Subscriber(f"/{name}/acoustic/status", TransmitStatus, self.status.append)]

    def odometry(self, stamp):
        """Returns the vehicle's odometry at that time."""
        message = Odometry(child_frame_id=f"{self.name}/base_link")
        message.header.stamp, message.header.frame_id = stamp, "world"
        p = message.pose.pose.position
        p.x, p.y, p.z = self.position
        message.pose.pose.orientation.w = 1.0
        return message

    def say(self, data, destination=-1, stamp=rospy.Time(0)):
        """Offers a packet; returns its number."""
        self.said += 1
        packet = AcousticPacket(destination=destination, sequence=self.said, data=data)
        packet.header.stamp = stamp
        self.tx.publish(packet)
        return self.said

    def fate(self, number):
        """Returns the statuses of one packet of the vehicle, in order."""
        return [s for s in self.status if s.sequence == number]

    def heard(self, data):
        """Returns the received packets with that payload."""
        return [p for p in self.received if p.data == data]

    def connected(self):
        """Tells whether the channel hears the vehicle and the vehicle hears the channel."""
        return all(c.get_num_connections() > 0 for c in (self.odom, self.tx, *self._subscribers))


class World:
    """Publishes /clock and the odometry of all vehicles, ten times in a second of its own time. `pause_s` is
    the wall time between two of them."""

    PERIOD_NS = 100_000_000

    def __init__(self, vehicles, start_s=1000.0, pause_s=0.02):
        self.vehicles, self._pause_s = vehicles, pause_s
        self._clock = rospy.Publisher("/clock", Clock, queue_size=100)
        self._now = rospy.Time.from_sec(start_s)
        self._lock = threading.Lock()
        wait_for(lambda: all(v.connected() for v in vehicles), 30.0, "the channel")
        threading.Thread(target=self._run, daemon=True).start()

    def _run(self):
        with contextlib.suppress(rospy.ROSException):  # the topics are closed at the end
            while not rospy.is_shutdown():
                with self._lock:
                    self._now += rospy.Duration(0, self.PERIOD_NS)
                    self._clock.publish(self._now)
                    for vehicle in self.vehicles:
                        if not vehicle.silent:
                            vehicle.odom.publish(vehicle.odometry(self._now))
                time.sleep(self._pause_s)

    def now(self):
        """Returns the time that was published last."""
        with self._lock:
            return self._now

    def leap(self, seconds):
        """Sets the clock forward or back."""
        with self._lock:
            self._now += rospy.Duration.from_sec(seconds)

    def pass_time(self, seconds):
        """Waits for so many seconds of its own time."""
        end = self.now() + rospy.Duration.from_sec(seconds)
        wait_for(lambda: self.now() >= end, 60.0, f"{seconds} s of simulated time")
