"""The module's own spaces act as Gymnasium's do."""

import unittest

import numpy as np

from stg import spaces


class Spaces(unittest.TestCase):
    def test_samples_lie_in_their_space_and_follow_the_seed(self):
        for space in (
            spaces._Box(-1.0, 1.0, (4, 3)),
            spaces._Box(-np.inf, np.inf, (5,)),
            spaces._Box(np.array([0.0, -2.0]), np.array([0.5, np.inf])),
            spaces._Discrete(7),
            spaces._Discrete(3, start=-1),
            spaces._MultiDiscrete([2, 5, 3]),
            spaces._batch(spaces._MultiDiscrete([2, 5]), 3),
        ):
            with self.subTest(space):
                space.seed(4)
                first = [space.sample() for _ in range(50)]
                self.assertTrue(all(x in space for x in first))
                self.assertGreater(len({np.asarray(x).tobytes() for x in first}), 1)
                space.seed(4)
                self.assertTrue(all(np.array_equal(x, space.sample()) for x in first))

    def test_what_does_not_fit_is_outside(self):
        box = spaces._Box(-1.0, 1.0, (2,))
        for x in ([0.0, 0.0], np.zeros(3, np.float32), np.full(2, 2.0, np.float32),
                  np.zeros(2, np.float64), np.full(2, np.nan, np.float32)):  # fmt: skip
            self.assertFalse(box.contains(x), repr(x))
        self.assertTrue(box.contains(np.array([1.0, -1.0], np.float32)))
        self.assertFalse(any(x in spaces._Discrete(3) for x in (-1, 3, 1.0, True, np.array([1]))))
        self.assertTrue(np.int32(2) in spaces._Discrete(3))
        two = spaces._MultiDiscrete([2, 3])
        self.assertTrue(np.array([1, 2]) in two)
        self.assertFalse(any(np.array(x) in two for x in ([2, 0], [0, -1], [0.0, 0.0], [0])))

    def test_batches_repeat_the_bounds(self):
        batch = spaces._batch(spaces._Box(np.array([0.0, 1.0]), np.array([2.0, 3.0])), 4)
        self.assertEqual(batch.shape, (4, 2))
        self.assertTrue(np.array_equal(batch.low[3], [0.0, 1.0]))
        self.assertEqual(spaces._batch(spaces._Discrete(5), 2), spaces._MultiDiscrete([5, 5]))
        self.assertNotEqual(spaces._Box(0.0, 1.0, (2,)), spaces._Box(0.0, 1.0, (3,)))

    def test_contradictions_are_refused(self):
        for make in (lambda: spaces._Box(1.0, 0.0, (1,)), lambda: spaces._Discrete(0),
                     lambda: spaces._MultiDiscrete([1, 0])):  # fmt: skip
            self.assertRaises(ValueError, make)


if __name__ == "__main__":
    unittest.main()
