#!/usr/bin/python3
"""On the wall clock: the threads that a wrench waits for have real-time priority; agents are small."""

import os
import pathlib
import re
import unittest

import rospy
import rostest
from geometry_msgs.msg import WrenchStamped
from graph_listener import Latest, rosnode_pid

PRIORITY = 7  # as in realtime.test
ON_THE_WAY = ["/world", "/acoustic_channel", "/auv_0/agent", "/auv_3/agent", "/auv_0/controller"]


def permitted():
    """Tells whether this system lets this user's processes have a real-time priority."""
    before = os.sched_getscheduler(0)
    try:
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(PRIORITY))
    except PermissionError:
        return False
    os.sched_setscheduler(0, before, os.sched_param(0))
    return True


def realtime_threads(node):
    """Returns the priorities of the threads of a node that have a real-time priority."""
    tasks = pathlib.Path(f"/proc/{rosnode_pid(node)}/task")
    threads = [int(entry.name) for entry in tasks.iterdir()]
    return [os.sched_getparam(thread).sched_priority for thread in threads
            if os.sched_getscheduler(thread) & ~os.SCHED_RESET_ON_FORK == os.SCHED_RR]


def resident_kb(node, field="VmRSS"):
    """Returns the resident memory of a node, or a part of it, e.g. RssFile."""
    status = pathlib.Path(f"/proc/{rosnode_pid(node)}/status").read_text(encoding="utf-8")
    return int(re.search(rf"{field}:\s*(\d+)", status).group(1))


class Realtime(unittest.TestCase):
    """A run at the pace of the wall clock."""

    def test_one_thread_of_each_node_on_the_way_goes_first(self):
        if not permitted():
            self.skipTest("this system gives its users no real-time priority")
        Latest("/auv_0/wrench", WrenchStamped).wait_for_more(5, 30.0)
        for node in ON_THE_WAY:
            self.assertEqual(realtime_threads(node), [PRIORITY], node)

    def test_without_permission_the_graph_runs_all_the_same(self):
        if permitted():
            self.skipTest("this system gives real-time priorities")
        Latest("/auv_0/wrench", WrenchStamped).wait_for_more(5, 30.0)
        for node in ON_THE_WAY:
            self.assertEqual(realtime_threads(node), [], node)

    def test_an_agent_keeps_few_pages_after_its_start(self):
        Latest("/auv_0/wrench", WrenchStamped).wait_for_more(20, 30.0)
        for i in range(4):
            self.assertLess(resident_kb(f"/auv_{i}/agent"), 16 * 1024)

    def test_who_only_watches_has_none(self):
        Latest("/auv_0/wrench", WrenchStamped).wait_for_more(5, 30.0)
        self.assertEqual(realtime_threads("/metrics"), [])


if __name__ == "__main__":
    rospy.init_node("realtime_test")
    rostest.rosrun("stg_bringup", "realtime", Realtime)
