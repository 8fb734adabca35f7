"""Pictures show what they say, and snapshots hold the truth."""

import unittest

import matplotlib.colors
import matplotlib.figure
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg

import stg
from stg import render


def pixels(picture, colour):
    """Number of pixels of nearly this colour."""
    wanted = np.array(matplotlib.colors.to_rgb(colour)) * 255.0
    return int(np.sum(np.abs(picture.astype(float) - wanted).max(axis=2) < 12.0))


class Pictures(unittest.TestCase):
    def fly(self, steps, **options):
        """Returns an environment after some steps of a controller."""
        env = stg.parallel_env(seed=5, render_mode="rgb_array", **options)
        env.reset()
        for _ in range(steps):
            env.step(env.controller_actions("pursuit_separated"))
        return env

    def test_a_picture_shows_every_vehicle_and_the_target(self):
        picture = self.fly(40).render()
        self.assertEqual((picture.shape, picture.dtype), ((540, 1000, 3), np.uint8))
        for colour in (*render.COLOURS[:4], "#d02060"):
            self.assertGreater(pixels(picture, colour), 50, colour)
        self.assertLess(pixels(picture, render.COLOURS[5]), 20)

    def test_a_report_holds_every_remembered_step(self):
        from stg_view.recording import messages

        env = self.fly(30)
        page = stg.report(env)
        self.assertIn("Content-Security-Policy", page.html)
        self.assertNotIn("<script", page._repr_html_())
        data = stg.page.recording_of(env._history, env.scenario, "x")
        steps = [columns for header, columns in messages(data) if header["kind"] == "steps"]
        self.assertEqual(31, sum(len(columns["t"]) for columns in steps))
        np.testing.assert_array_equal(
            steps[0]["position"][-1], env.snapshot()["position"].ravel().astype(np.float32))  # fmt: skip
        with self.assertRaisesRegex(ValueError, "render_mode"):
            stg.report(stg.parallel_env())

    def test_the_legend_of_eight_is_in_the_picture(self):
        env = self.fly(2, overrides={"agents": 8})
        figure = matplotlib.figure.Figure(figsize=(10.0, 5.4), dpi=100)
        canvas = FigureCanvasAgg(figure)
        render.draw_views(figure, [env.snapshot()], env.scenario)
        canvas.draw()
        box = figure.legends[0].get_window_extent()
        self.assertGreater(box.x0, 0.0)
        self.assertLess(box.x1, 1000.0)
        self.assertLess(box.y1, figure.axes[0].xaxis.label.get_window_extent().y0)

    def test_a_flat_swarm_has_heights_of_its_own_scale(self):
        env = self.fly(2)
        shot = env.snapshot()
        for name in ("position", "target_position", "estimate"):
            shot[name][:, 2] *= 0.01
        figure = matplotlib.figure.Figure()
        render.draw_views(figure, [shot], env.scenario)
        side = figure.axes[1]
        self.assertIn("heights", side.get_title())
        self.assertLess(np.ptp(side.get_ylim()), 0.2 * np.ptp(side.get_xlim()))

    def test_tracks_grow(self):
        early, late = self.fly(2).render(), self.fly(60).render()
        self.assertGreater(np.sum(early != late), 1000)

    def test_links_are_drawn_where_there_are_some(self):
        silent = self.fly(20, overrides={"mode": "truth", "channel.range_m": 0.001})
        self.assertEqual(silent.snapshot()["links"].max(), 0.0)
        self.assertGreater(self.fly(20, overrides={"mode": "truth"}).snapshot()["links"].max(), 0.1)

    def test_without_a_render_mode_there_is_no_picture(self):
        env = stg.parallel_env()
        env.reset()
        self.assertIsNone(env.render())
        self.assertIsNone(stg.vector_env("medium", 2).render())
        with self.assertRaisesRegex(RuntimeError, "reset"):
            stg.parallel_env(render_mode="rgb_array").render()

    def test_vector_environments_give_one_picture_each(self):
        env = stg.vector_env("two_targets", 2, render_mode="rgb_array")
        env.reset(seed=1)
        first, second = env.render()
        self.assertEqual(first.shape, (540, 1000, 3))
        self.assertTrue(np.any(first != second))


class Snapshots(unittest.TestCase):
    def test_the_truth_agrees_with_the_observation_in_truth_mode(self):
        env = stg.parallel_env(overrides={"mode": "truth"})
        observations, _ = env.reset(seed=2)
        shot = env.snapshot()
        extent = env.scenario["workspace.half_extent_m"]
        blocks = {name: slice(at, at + n) for name, at, n, _ in env.scenario.observation_blocks}
        for i, name in enumerate(env.agents):
            seen = observations[name]
            np.testing.assert_allclose(seen[blocks["position"]], shot["position"][i] / extent, atol=1e-6)
            offset = (shot["target_position"][0] - shot["position"][i]) / extent
            np.testing.assert_allclose(seen[blocks["target_offset"]], offset, atol=1e-6)
            np.testing.assert_allclose(shot["estimate"][i], shot["target_position"][0], atol=1e-9)
            self.assertAlmostEqual(shot["tracking"][i, 0], np.linalg.norm(offset) * extent)

    def test_time_goes_on(self):
        env = stg.parallel_env()
        env.reset(seed=2)
        for k in range(3):
            self.assertEqual(env.snapshot()["step"], k)
            self.assertAlmostEqual(env.snapshot()["time"], k * env.scenario.decision_dt_s)
            env.step({name: np.zeros(3, np.float32) for name in env.agents})


if __name__ == "__main__":
    unittest.main()
