"""Packet codec, target filter and agents from Python."""

import unittest

import numpy as np

import stg

SECOND = 10**9


class Packets(unittest.TestCase):
    def setUp(self):
        self.codec = stg.PacketCodec(stg.load_scenario("medium"))
        self.state = stg.NeighbourState()
        self.state.source, self.state.generation = 2, 7 * SECOND
        self.state.p_W, self.state.v_W = (0.5, -0.25, 0.1), (0.01, 0.02, -0.03)
        self.state.confidence, self.state.phase, self.state.has_target = 0.75, 2, True
        self.state.target_stamp, self.state.target_std = 6 * SECOND, 0.01
        self.state.p_WT, self.state.v_WT = (0.4, -0.3, 0.2), (0.001, 0.0, -0.002)

    def test_a_packet_comes_back_to_within_its_resolution(self):
        data = self.codec.encode(self.state)
        self.assertEqual((type(data), len(data)), (bytes, 32))
        got = self.codec.decode(data, 8 * SECOND)
        self.assertEqual((got.source, got.generation, got.phase), (2, 7 * SECOND, 2))
        self.assertTrue(got.has_target and not got.saturated)
        np.testing.assert_allclose(got.p_W, self.state.p_W, atol=1e-4)
        np.testing.assert_allclose(got.p_WT, self.state.p_WT, atol=1e-4)
        self.assertAlmostEqual(got.target_std, 0.01, delta=5e-4)

    def test_damage_and_nonsense_are_refused(self):
        data = bytearray(self.codec.encode(self.state))
        data[9] ^= 4
        with self.assertRaises(stg.UserError):
            self.codec.decode(bytes(data), 8 * SECOND)
        with self.assertRaises(stg.UserError):
            self.codec.decode(b"short", 8 * SECOND)
        self.state.p_W = (np.nan, 0.0, 0.0)
        with self.assertRaises(ValueError):
            self.codec.encode(self.state)
        with self.assertRaises(TypeError):
            self.state.p_W = (0.0, 0.0)


class Track(unittest.TestCase):
    def test_exact_detections_of_a_straight_course_give_the_course(self):
        track = stg.TargetTrack(stg.load_scenario("medium"))
        self.assertFalse(track.started)
        place, speed = np.array([0.1, 0.2, -0.1]), np.array([0.01, -0.005, 0.002])
        for k in range(60):
            track.detect(k * SECOND // 2, place + 0.5 * k * speed, 1e-3)
        track.predict(40 * SECOND)
        estimate = track.estimate
        self.assertEqual(estimate["stamp"], 40 * SECOND)
        np.testing.assert_allclose(estimate["v_WT"], speed, atol=2e-3)
        np.testing.assert_allclose(estimate["p_WT"], place + 40 * speed, atol=2e-2)
        before = estimate["position_std_m"]
        track.predict(45 * SECOND)
        self.assertGreater(track.estimate["position_std_m"], before)

    def test_a_shared_estimate_never_makes_it_less_certain(self):
        track = stg.TargetTrack(stg.load_scenario("medium"))
        track.start((0.0, 0.0, 0.0), 0.1, 0)
        track.predict(SECOND)
        before = track.estimate["position_std_m"]
        track.fuse(SECOND, (0.02, 0.0, 0.0), (0.0, 0.0, 0.0), 0.01)
        self.assertLess(track.estimate["position_std_m"], before)
        with self.assertRaises(ValueError):
            track.detect(SECOND, (np.inf, 0.0, 0.0), 0.01)


class Agents(unittest.TestCase):
    def setUp(self):
        self.scenario = stg.load_scenario("medium")
        self.rest = {"q_WB": (1.0, 0.0, 0.0, 0.0), "v_WB_B": (0.0,) * 3, "w_WB_B": (0.0,) * 3}

    def test_agents_hear_of_each_other_and_of_the_target(self):
        a, b = stg.Agent(self.scenario, 0), stg.Agent(self.scenario, 1)
        a.reset(cue=(0.0, 0.0, 0.0), cue_std_m=0.3)
        b.reset(cue=(0.0, 0.0, 0.0), cue_std_m=0.3)
        a.detect(0, (0.2, 0.1, 0.0), 0.001)
        a.observe(0, (0.3, 0.1, 0.0), **self.rest)
        a.act(np.zeros(3, np.float32))
        b.observe(0, (-0.3, 0.1, 0.0), **self.rest)
        self.assertEqual(b.neighbours, [])
        b.receive(a.make_packet(), SECOND // 20)
        seen = b.observe(SECOND // 10, (-0.3, 0.1, 0.0), **self.rest)
        self.assertEqual(b.neighbours, [0])
        np.testing.assert_allclose(b.track["p_WT"], (0.2, 0.1, 0.0), atol=0.01)
        offsets = {name: at for name, at, _, _ in self.scenario.observation_blocks}
        extent = self.scenario["workspace.half_extent_m"]
        self.assertAlmostEqual(seen[offsets["neighbours"]] * extent, 0.6, places=3)
        self.assertEqual((seen.shape, seen.dtype), ((74,), np.float32))

    def test_an_action_becomes_a_velocity_and_a_force(self):
        agent = stg.Agent(self.scenario, 0)
        agent.reset(cue=(0.0, 0.0, 0.0), cue_std_m=0.3)
        agent.observe(0, (0.3, 0.0, 0.0), **self.rest)
        out = agent.act(np.array([1.0, 0.0, 0.0], np.float32))
        self.assertGreater(out["cmd_vel"][0], 0.0)
        self.assertGreater(out["force"][0], 0.0)
        self.assertEqual(len(out["moment"]), 3)

    def test_wrong_input_is_refused(self):
        with self.assertRaisesRegex(ValueError, "4 AUVs"):
            stg.Agent(self.scenario, 4)
        with self.assertRaisesRegex(stg.UserError, "has the mode truth, but an agent has only"):
            stg.Agent(stg.load_scenario("medium_release"), 0)
        agent = stg.Agent(self.scenario, 0)
        agent.reset()
        with self.assertRaises(ValueError):
            agent.observe(0, (np.nan, 0.0, 0.0), **self.rest)
        agent.observe(0, (0.0, 0.0, 0.0), **self.rest)
        with self.assertRaisesRegex(ValueError, "shape"):
            agent.act(np.zeros(4, np.float32))
        with self.assertRaises(ValueError):
            agent.act(np.full(3, np.nan, np.float32))
        agent.receive(b"noise", 0)  # it is counted and ignored
        self.assertEqual(agent.neighbours, [])


if __name__ == "__main__":
    unittest.main()
