#!/usr/bin/python3
"""The search maps that the agents of `search` publish are those that follow from datum and looks."""

import math
import unittest

import numpy
import rospy
import rostest
import std_msgs.msg
import yaml
from auv_msgs.msg import SensorFrame
from nav_msgs.msg import OccupancyGrid

from stg_common.waiting import wait_for

AGENTS = 4
PERIOD_S = 5  # between two maps, and between two looks
LAST_S = 20  # from 25 s on, the map also spreads
ROUNDING = 0.51


class SearchMaps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.maps = [{} for _ in range(AGENTS)]
        cls.frames = [{} for _ in range(AGENTS)]
        cls.scenario = None
        cls.start = None
        for i in range(AGENTS):
            rospy.Subscriber(f"/auv_{i}/search_map", OccupancyGrid, cls.keep, cls.maps[i])
            rospy.Subscriber(f"/auv_{i}/sensor_frame", SensorFrame, cls.keep_frame, cls.frames[i])
        rospy.Subscriber("/scenario", std_msgs.msg.String, cls.keep_scenario)
        wait_for(lambda: cls.scenario and all(len(maps) * PERIOD_S > 2 * LAST_S for maps in cls.maps), 120.0,
                 "search maps")
        cls.start = min(min(frames) for frames in cls.frames)

    @staticmethod
    def keep(message, messages):
        messages.setdefault(message.header.stamp.to_nsec(), message)

    @classmethod
    def keep_frame(cls, message, messages):
        if message.episode == 0:
            cls.keep(message, messages)

    @classmethod
    def keep_scenario(cls, message):
        cls.scenario = yaml.safe_load(message.data)

    def time_s(self, stamp):
        return round((stamp - self.start) * 1e-9, 6)

    def places(self, i, until_s):
        """Returns where AUV i believed to be at each look until a time, that time included."""
        return [(frame.pose.position.x, frame.pose.position.y)
                for stamp, frame in sorted(self.frames[i].items())
                if self.time_s(stamp) <= until_s and self.time_s(stamp) % PERIOD_S == 0]

    def middles(self, grid):
        """Returns x and y of the middle of each cell, as the message defines them."""
        info = grid.info
        steps = (numpy.arange(info.width) + 0.5) * info.resolution
        return numpy.meshgrid(info.origin.position.x + steps, info.origin.position.y + steps)

    def chance(self, x, y, place):
        """Returns the probability that a look from a place detects a target in each cell."""
        sensing = self.scenario["sensing"]
        share = numpy.hypot(x - place[0], y - place[1]) / sensing["range_m"]
        p = sensing["detection_probability"] * (1.0 - (1.0 - sensing["range"]["probability_at_range"]) * share**2)
        return numpy.where(share > 1.0, 0.0, p)

    def own_looks(self, i, grid, until_s):
        """Returns the map, scaled to its largest cell, if AUV i used only its own looks; and the cells inside."""
        x, y = self.middles(grid)
        frame = self.frames[i][self.start]
        p = numpy.exp(-0.5 * ((x - frame.cue_position.x) ** 2 + (y - frame.cue_position.y) ** 2) / frame.cue_std**2)
        half = self.scenario["workspace"]["half_extent_m"]
        inside = (abs(x) <= half) & (abs(y) <= half)
        p[~inside] = 0.0
        for place in self.places(i, until_s):
            p *= 1.0 - self.chance(x, y, place)
        return 100.0 * p / p.max(), inside

    def published(self):
        """Yields AUV, time and message of the maps that are compared."""
        for i, maps in enumerate(self.maps):
            for stamp, grid in sorted(maps.items()):
                if self.time_s(stamp) <= LAST_S:
                    yield i, self.time_s(stamp), grid

    def test_the_grid_lies_where_the_map_lies(self):
        cell = self.scenario["track"]["search_cell_m"]
        for _, _, grid in self.published():
            info = grid.info
            self.assertEqual(grid.header.frame_id, "world")
            self.assertEqual((info.width, info.height, len(grid.data)), (32, 32, 1024))
            self.assertEqual(info.resolution, cell)
            # The map is wider than the region, so their middles are the same.
            self.assertEqual((info.origin.position.x, info.origin.position.y), (-16 * cell, -16 * cell))
            self.assertEqual(info.origin.position.z, 0.0)
            q = info.origin.orientation
            self.assertEqual((q.x, q.y, q.z, q.w), (0.0, 0.0, 0.0, 1.0))

    def test_a_map_comes_every_five_seconds(self):
        for maps in self.maps:
            times = [self.time_s(stamp) for stamp in sorted(maps)][: LAST_S // PERIOD_S + 1]
            self.assertEqual(times, list(range(0, LAST_S + 1, PERIOD_S)))

    def test_the_first_map_is_that_of_datum_and_own_look(self):
        for i, time_s, grid in self.published():
            if time_s > 0:
                continue
            expected, inside = self.own_looks(i, grid, 0)
            values = numpy.reshape(grid.data, (32, 32))
            self.assertTrue((values[~inside] == -1).all())
            self.assertGreater((~inside).sum(), 0)
            self.assertLess(abs(values - expected)[inside].max(), ROUNDING)
            self.assertEqual(values.max(), 100)
            self.assertEqual(values[numpy.unravel_index(expected.argmax(), expected.shape)], 100)

    def test_later_maps_differ_only_where_other_auvs_looked(self):
        heard = 0
        for i, time_s, grid in self.published():
            expected, inside = self.own_looks(i, grid, time_s)
            x, y = self.middles(grid)
            # The places in packets are rounded, and packets leave between two looks.
            reach = self.scenario["sensing"]["range_m"] + 25.0
            apart = numpy.full(x.shape, math.inf)
            for j in range(AGENTS):
                for place in self.places(j, time_s):
                    apart = numpy.minimum(apart, numpy.hypot(x - place[0], y - place[1]))
            top = numpy.unravel_index(expected.argmax(), expected.shape)
            self.assertGreater(apart[top], reach, "the largest cell is out of reach, so the scale is known")
            values = numpy.reshape(grid.data, (32, 32))
            free = inside & (apart > reach)
            self.assertLess(abs(values - expected)[free].max(), ROUNDING)
            within = inside & (apart <= reach)
            self.assertTrue((values[within] <= expected[within] + ROUNDING).all())
            heard += int((values[within] < expected[within] - 1.0).sum())
        self.assertGreater(heard, 0, "no map contains a look of another AUV")


if __name__ == "__main__":
    rospy.init_node("search_map")
    rostest.rosrun("stg_bringup", "search_map", SearchMaps)
