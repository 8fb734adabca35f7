"""Gymnasium's spaces if it can be imported; otherwise the needed ones, with the same behaviour."""

import numpy as np

__all__ = ["Box", "Discrete", "MultiDiscrete", "batch_space", "have_gymnasium"]


class _Space:
    """Common part of Box, Discrete and MultiDiscrete."""

    def __init__(self, shape, dtype, seed=None):
        self.shape = tuple(int(n) for n in shape)
        self.dtype = np.dtype(dtype)
        self.seed(seed)

    def seed(self, seed=None):
        """Makes later samples depend on `seed` (an integer; None: not repeatable)."""
        self._random = np.random.default_rng(seed)
        return seed

    @property
    def np_random(self):
        """The generator that samples are drawn from."""
        return self._random

    def __contains__(self, x):
        return self.contains(x)

    def __eq__(self, other):
        return type(self) is type(other) and repr(self) == repr(other)

    __hash__ = None


class _Box(_Space):
    """Arrays of one shape with numbers in [low, high]. @param low, high numbers or arrays"""

    def __init__(self, low, high, shape=None, dtype=np.float32, seed=None):
        if shape is None:
            shape = np.broadcast(np.asarray(low), np.asarray(high)).shape
        super().__init__(shape, dtype, seed)
        self.low = np.broadcast_to(np.asarray(low, self.dtype), self.shape).copy()
        self.high = np.broadcast_to(np.asarray(high, self.dtype), self.shape).copy()
        if not np.all(self.low <= self.high):
            raise ValueError("Box: low is above high")

    def sample(self):
        """An array: uniform where both bounds are finite, otherwise normal."""
        bounded = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = np.where(bounded, self.low, 0.0), np.where(bounded, self.high, 1.0)
        drawn = np.where(
            bounded, self._random.uniform(low, high), self._random.normal(size=self.shape)
        )
        return np.clip(drawn, self.low, self.high).astype(self.dtype)

    def contains(self, x):
        """True if `x` is an array of this shape, with a suitable type, within the bounds."""
        return (
            isinstance(x, np.ndarray)
            and np.can_cast(x.dtype, self.dtype)
            and x.shape == self.shape
            and bool(np.all(x >= self.low) and np.all(x <= self.high))
        )

    def __repr__(self):
        low, high = (
            str(b.flat[0]) if b.size and np.all(b == b.flat[0]) else str(b.tolist())
            for b in (self.low, self.high)
        )
        return f"Box({low}, {high}, {self.shape}, {self.dtype})"


class _Discrete(_Space):
    """The integers from start to start + n - 1."""

    def __init__(self, n, seed=None, start=0):
        if n < 1:
            raise ValueError("Discrete: n must be at least 1")
        super().__init__((), np.int64, seed)
        self.n, self.start = int(n), int(start)

    def sample(self):
        """An integer (numpy's int64)."""
        return np.int64(self.start + self._random.integers(self.n))

    def contains(self, x):
        """True if `x` is one of the integers."""
        if isinstance(x, np.ndarray) and x.shape != ():
            return False
        whole = isinstance(x, (int, np.integer)) or getattr(x, "dtype", np.dtype(float)).kind in "iu"
        return whole and not isinstance(x, bool) and 0 <= int(x) - self.start < self.n

    def __repr__(self):
        return f"Discrete({self.n}, start={self.start})" if self.start else f"Discrete({self.n})"


class _MultiDiscrete(_Space):
    """Arrays of integers, each from 0 to its nvec - 1."""

    def __init__(self, nvec, dtype=np.int64, seed=None):
        self.nvec = np.asarray(nvec, dtype=dtype)
        if self.nvec.size and self.nvec.min() < 1:
            raise ValueError("MultiDiscrete: all of nvec must be at least 1")
        super().__init__(self.nvec.shape, dtype, seed)

    def sample(self):
        """An array of nvec's shape."""
        return self._random.integers(0, self.nvec, dtype=self.dtype)

    def contains(self, x):
        """True if `x` is an array of integers of this shape, each in its range."""
        return (
            isinstance(x, np.ndarray)
            and x.dtype.kind in "iu"
            and x.shape == self.shape
            and bool(np.all(x >= 0) and np.all(x < self.nvec))
        )

    def __repr__(self):
        return f"MultiDiscrete({self.nvec.tolist()})"


def _batch(space, n):
    """The space of `n` elements of `space`; the first index counts them."""
    if isinstance(space, _Box):
        low, high = (np.repeat(b[None], n, axis=0) for b in (space.low, space.high))
        return _Box(low, high, dtype=space.dtype)
    if isinstance(space, _Discrete) and space.start == 0:
        return _MultiDiscrete(np.full(n, space.n))
    if isinstance(space, _MultiDiscrete):
        return _MultiDiscrete(np.repeat(space.nvec[None], n, axis=0), space.dtype)
    raise TypeError(f"no batch of {space}")


try:
    from gymnasium.spaces import Box, Discrete, MultiDiscrete
    from gymnasium.vector.utils import batch_space

    have_gymnasium = True
except ImportError:
    Box, Discrete, MultiDiscrete, batch_space = _Box, _Discrete, _MultiDiscrete, _batch
    have_gymnasium = False
