#!/usr/bin/python3
"""An agent that dies in the middle of an episode comes back to its search and its slot."""

import unittest

import rospy
import rostest
from auv_msgs.msg import AcousticPacket, SensorFrame, TaskState
from graph_listener import Latest, kill, wait_for, wait_for_restart

PERIOD = 5  # decisions between two packets of an AUV
KILLED, UNTOUCHED = 3, 1


class All:
    """Keeps every message of a topic by its stamp."""

    def __init__(self, topic, message_type):
        self.messages = {}
        self._subscriber = rospy.Subscriber(topic, message_type, self._keep, queue_size=1000)

    def _keep(self, message):
        self.messages[message.header.stamp] = message


class Restart(unittest.TestCase):
    """One long episode without a detection. The agent of AUV 3 is killed again and again."""

    @classmethod
    def setUpClass(cls):
        cls.tasks = {i: All(f"/auv_{i}/task_state", TaskState) for i in (KILLED, UNTOUCHED)}
        cls.packets = All(f"/auv_{KILLED}/acoustic/tx", AcousticPacket)
        cls.steps = All(f"/auv_{KILLED}/sensor_frame", SensorFrame)
        cls.task = Latest(f"/auv_{KILLED}/task_state", TaskState)
        cls.lives = []  # [(first step of a life, its last one)]
        cls.task.wait_for_more(12, 30.0)
        for _ in range(4):
            pid = kill(f"/auv_{KILLED}/agent")
            wait_for_restart(f"/auv_{KILLED}/agent", pid)
            died = cls.task.message.step
            wait_for(lambda died=died: cls.task.message.step > died + 5, 20.0, "decisions again")
            cls.task.wait_for_more(2 * PERIOD + 2)
            cls.lives.append((died + 1, cls.task.message.step))

    def test_it_knows_the_target_as_one_that_never_died(self):
        common = sorted(set(self.tasks[KILLED].messages) & set(self.tasks[UNTOUCHED].messages))
        for first, last in self.lives:
            found = 0
            for stamp in common:
                back, always = (self.tasks[i].messages[stamp] for i in (KILLED, UNTOUCHED))
                if not first <= back.step <= last:
                    continue
                found += 1
                self.assertTrue(back.target_known, f"step {back.step}")
                self.assertAlmostEqual(back.target_std, always.target_std, 9)
                for axis in "xyz":
                    self.assertAlmostEqual(getattr(back.target_position, axis),
                                           getattr(always.target_position, axis), 9)
            self.assertGreater(found, PERIOD)

    def test_it_transmits_in_its_own_slot_of_the_episode(self):
        for first, last in self.lives:
            slots = {self.steps.messages[stamp].step % PERIOD
                     for stamp, packet in self.packets.messages.items()
                     if packet.data and stamp in self.steps.messages
                     and first <= self.steps.messages[stamp].step <= last}
            self.assertEqual(slots, {KILLED % PERIOD})


if __name__ == "__main__":
    rospy.init_node("restart_test")
    rostest.rosrun("stg_bringup", "restart", Restart)
