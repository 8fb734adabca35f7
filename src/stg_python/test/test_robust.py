"""Wrong input is refused clearly and changes nothing; memory, threads and processes behave."""

import multiprocessing
import subprocess
import sys
import threading
import time
import unittest

import numpy as np

import stg


CYCLE = {"time": {}}
CYCLE["time"]["time"] = CYCLE
CYCLIC_LIST = [1]
CYCLIC_LIST.append(CYCLIC_LIST)


def deep(count):
    """Returns `count` dictionaries within each other."""
    values = {}
    for _ in range(count):
        values = {"a": values}
    return values


def resident_bytes():
    """Memory of this process."""
    with open("/proc/self/statm", encoding="ascii") as statm:
        return int(statm.read().split()[1]) * 4096


class WrongActions(unittest.TestCase):
    """Each is refused with a message that names what is wrong; then everything goes on."""

    def test_of_a_vector_environment(self):
        env, twin = stg.vector_env("medium", 5), stg.vector_env("medium", 5)
        for e in (env, twin):
            e.reset(seed=2)
        good = np.zeros((5, 4, 3), np.float32)
        one_nan, one_inf = good.copy(), good.astype(np.float64)
        one_nan[3, 2, 1], one_inf[0, 0, 2] = np.nan, np.inf
        for wrong, error, words in (
            (good[:4], ValueError, r"\(5, 4, 3\), not \(4, 4, 3\)"),
            (good[..., :2], ValueError, r"not \(5, 4, 2\)"),
            (good.ravel(), ValueError, r"not \(60,\)"),
            (good.astype(np.int64), TypeError, "int64"),
            (good.astype(np.float16), TypeError, "float16"),
            (good.tolist(), TypeError, "list"),
            (None, TypeError, "NoneType"),
            (one_nan, ValueError, r"\[3, 2, 1\] is not finite"),
            (one_inf, ValueError, r"\[0, 0, 2\] is not finite"),
        ):
            with self.assertRaisesRegex(error, words):
                env.step(wrong)
            self.assertTrue(np.array_equal(env.step(good)[0], twin.step(good)[0]))

    def test_of_a_parallel_environment(self):
        env, twin = stg.parallel_env(), stg.parallel_env()
        good = {f"auv_{i}": np.zeros(3, np.float32) for i in range(4)}
        with self.assertRaisesRegex(RuntimeError, "reset"):
            env.step(good)
        for e in (env, twin):
            e.reset(seed=2)
        nan = np.array([0.0, 0.0, np.nan])
        for wrong, error, words in (
            ({k: good[k] for k in list(good)[:3]}, ValueError, "no action for auv_3"),
            ({**good, "auv_9": good["auv_0"]}, ValueError, "5 AUVs"),
            ({**good, "auv_1": np.zeros(2, np.float32)}, ValueError, "auv_1.*shape"),
            ({**good, "auv_1": [0.0, 0.0, 0.0]}, TypeError, "auv_1.*list"),
            ({**good, "auv_1": np.zeros(3, int)}, TypeError, "auv_1.*int64"),
            ({**good, "auv_2": nan}, ValueError, "auv_2: component 2 is not finite"),
            (list(good.values()), TypeError, "dictionary"),
            (None, TypeError, "dictionary"),
        ):
            with self.assertRaisesRegex(error, words):
                env.step(wrong)
            np.testing.assert_equal(env.step(good)[0], twin.step(good)[0])

    def test_after_the_end(self):
        env = stg.parallel_env(overrides={"time.episode_steps": 3, "time.tail_steps": 1})
        env.reset(seed=1)
        good = {name: np.zeros(3, np.float32) for name in env.agents}
        for _ in range(3):
            env.step(good)
        for _ in range(2):
            with self.assertRaisesRegex(RuntimeError, "ended"):
                env.step(good)
        env.reset()
        env.step(good)
        env.close()
        for call in (env.reset, env.snapshot):
            with self.assertRaisesRegex(RuntimeError, "closed"):
                call()
        envs = stg.vector_env("medium", 2)
        with self.assertRaisesRegex(RuntimeError, "reset"):
            envs.step(envs.action_space.sample())
        envs.close()
        with self.assertRaisesRegex(RuntimeError, "closed"):
            envs.reset()

    def test_of_the_rest(self):
        for call, error, words in (
            (lambda: stg.vector_env("medium", 0), stg.UserError, "num_envs"),
            (lambda: stg.vector_env("medium", 2.0), TypeError, "num_envs"),
            (lambda: stg.vector_env("medium", 10**9), stg.UserError,
             "num_envs: 1000000000 environments of 4 AUVs need more than .* GiB"),
            (lambda: stg.vector_env("medium", 10**10), ValueError, "num_envs: 10000000000"),
            (lambda: stg.vector_env("medium", 2, workers=0), stg.UserError, "workers"),
            (lambda: stg.vector_env("medium", 2, seed=-1), ValueError, "seed"),
            (lambda: stg.vector_env("medium", 2, seed=1.5), TypeError, "seed"),
            (lambda: stg.vector_env("medium", 2, rewards="sum"), ValueError, "rewards"),
            (lambda: stg.vector_env("medium", 2, render_mode="human"), ValueError, "render_mode"),
            (lambda: stg.vector_env(["medium", "swarm20"], 8), stg.UserError, "agree"),
            (lambda: stg.vector_env("medium", 8, condition=["nominal"] * 2, overrides=[{}] * 3),
             ValueError, "length"),
            (lambda: stg.vector_env("medium", 2).reset(seed=[1]), ValueError, "seed"),
            (lambda: stg.vector_env("medium", 2).reset(options={"speed": 1}), ValueError, "speed"),
            (lambda: stg.vector_env("medium", 2).metrics(2), IndexError, "environment 2 of 2"),
            (lambda: stg.vector_env("medium", 2, overrides="x"), TypeError, "overrides.*'x'"),
            (lambda: stg.parallel_env(overrides="x"), TypeError, "overrides.*'x'"),
            (lambda: stg.parallel_env(overrides=3), TypeError, "overrides"),
            (lambda: stg.parallel_env(overrides={3: 1}), TypeError, "overrides: keys must be strings"),
            (lambda: stg.parallel_env(overrides=CYCLE), ValueError, "a dict contains itself"),
            (lambda: stg.parallel_env(overrides={"a": CYCLIC_LIST}), ValueError,
             "a list contains itself"),
            (lambda: stg.parallel_env(overrides=deep(5000)), ValueError, "32 dictionaries"),
            (lambda: stg.parallel_env().reset(options="x"), TypeError, "options"),
            (lambda: stg.parallel_env(seed=2**63), ValueError, "seed"),
            (lambda: stg.parallel_env().reset(seed="1"), TypeError, "seed"),
        ):  # fmt: skip
            with self.subTest(words), self.assertRaisesRegex(error, words):
                call()

    def test_an_option_of_reset_gives_a_warning(self):
        """PettingZoo's parallel_api_test passes one."""
        env, twin = stg.parallel_env(), stg.parallel_env()
        with self.assertWarnsRegex(UserWarning, "speed had no effect"):
            told = env.reset(seed=3, options={"speed": 1})
        np.testing.assert_equal(told, twin.reset(seed=3))


class Resources(unittest.TestCase):
    def test_a_million_steps_take_no_more_memory(self):
        env = stg.vector_env("medium", 250, workers=2, overrides={"time.episode_steps": 200})
        actions = np.zeros((250, 4, 3), np.float32)
        env.reset(seed=1)
        for _ in range(400):  # pools, caches and two autoresets
            env.step(actions)
        before = resident_bytes()
        for _ in range(4000):
            env.step(actions)
        self.assertLess(resident_bytes() - before, 4 << 20)

    def test_environments_by_name_take_no_more_memory(self):
        env = stg.parallel_env(overrides={"time.episode_steps": 50, "time.tail_steps": 10})
        actions = {name: np.zeros(3, np.float32) for name in env.possible_agents}

        def fly(episodes):
            for _ in range(episodes):
                env.reset()
                while env.agents:
                    env.step(actions)
                with self.assertRaises(RuntimeError):
                    env.step(actions)

        fly(100)
        before = resident_bytes()
        fly(400)
        self.assertLess(resident_bytes() - before, 2 << 20)

    def test_making_and_closing_takes_no_more_memory(self):
        def make(count):
            for _ in range(count):
                stg.vector_env("medium", 32, workers=2).reset(seed=0)

        make(20)
        before = resident_bytes()
        make(60)
        self.assertLess(resident_bytes() - before, 8 << 20)


class Threads(unittest.TestCase):
    def test_other_threads_run_while_the_environments_step(self):
        """With a switch interval of a minute a thread gets the GIL only if another one gives it up."""
        env = stg.vector_env("medium", 8000)
        env.reset(seed=0)
        actions = np.zeros((8000, 4, 3), np.float32)
        state = {"inside": False, "done": False}

        def step():
            for _ in range(3):
                state["inside"] = True
                env._core.step(actions)
                state["inside"] = False
            state["done"] = True

        interval = sys.getswitchinterval()
        sys.setswitchinterval(60.0)
        seen = 0
        try:
            thread = threading.Thread(target=step)
            thread.start()
            while not state["done"]:
                seen += state["inside"]
                time.sleep(0.0)
            thread.join()
        finally:
            sys.setswitchinterval(interval)
        self.assertGreater(seen, 0)

    def test_a_second_thread_is_refused_and_harms_nothing(self):
        env, twin = stg.vector_env("medium", 2000), stg.vector_env("medium", 2000)
        for e in (env, twin):
            e.reset(seed=0)
        actions = np.zeros((2000, 4, 3), np.float32)
        outcomes = []

        def step():
            for _ in range(20):
                try:
                    env.step(actions)
                    outcomes.append("stepped")
                except RuntimeError as error:
                    outcomes.append(str(error))

        threads = [threading.Thread(target=step) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(set(outcomes) - {"stepped"}, {"another thread is using this environment"})
        for _ in range(outcomes.count("stepped")):
            wanted = twin.step(actions)
        self.assertTrue(np.array_equal(env.arrays["observations"], wanted[0]))

    def test_a_forked_process_is_told_to_make_its_own(self):
        env = stg.vector_env("medium", 8, workers=2)
        env.reset(seed=0)
        context = multiprocessing.get_context("fork")
        queue = context.Queue()

        def child():
            try:
                env.step(np.zeros((8, 4, 3), np.float32))
                queue.put("stepped")
            except RuntimeError as error:
                own = stg.vector_env("medium", 8, workers=2)
                own.reset(seed=0)
                queue.put(str(error))

        process = context.Process(target=child)
        process.start()
        self.assertIn("fork", queue.get(timeout=60))
        process.join(60)
        self.assertEqual(process.exitcode, 0)
        env.step(np.zeros((8, 4, 3), np.float32))


LEAVE = """
import threading, time, numpy as np, stg
env = stg.vector_env("medium", 400)
env.reset(seed=0)
def fly():
    actions = np.zeros((400, 4, 3), np.float32)
    while True:
        {call}
threading.Thread(target=fly, daemon=True).start()
time.sleep(0.3)
print("left")
"""


class Exit(unittest.TestCase):
    def test_of_the_program_while_a_daemon_thread_flies(self):
        """Python ends the thread where it asks for the GIL back; the program ended by SIGABRT."""
        for call in ("env.step(actions)", "stg.evaluate('pursuit', episodes=1)"):
            for _ in range(3):
                done = subprocess.run(
                    [sys.executable, "-c", LEAVE.format(call=call)], stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT, universal_newlines=True, check=False, timeout=120,
                )  # fmt: skip
                self.assertEqual((done.returncode, done.stdout), (0, "left\n"), call)


if __name__ == "__main__":
    unittest.main()
