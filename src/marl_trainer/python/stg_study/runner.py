"""Runs the jobs of a study in parallel processes. It can be interrupted, and it reports the progress."""

import os
import signal
import sys
import time

from stg_study import ranks
from stg_study.processes import heed

POLL_S = 0.05
SHOWN_LOG_LINES = 15
PATIENCE_S = 120.0  # time for a training to save after the first Ctrl-C


def duration(seconds):
    """A duration as text: 42 s, 3 min 20 s, 1 h 05 min."""
    seconds = int(round(seconds))
    if seconds < 60:
        return f"{seconds} s"
    if seconds < 3600:
        return f"{seconds // 60} min {seconds % 60:02d} s"
    return f"{seconds // 3600} h {seconds % 3600 // 60:02d} min"


class Estimate:
    """Remaining time, from the times of finished jobs and the progress of the running ones."""

    DEFAULT_S = {"training": None, "evaluation": 1.0}

    def __init__(self):
        self._seconds = {"training": [], "evaluation": []}

    def add(self, kind, seconds):
        """Stores the time of a finished job."""
        self._seconds[kind].append(seconds)

    def mean(self, kind, running):
        """Mean seconds of a job of `kind`, or None if it is unknown."""
        known = self._seconds[kind]
        if known:
            return sum(known) / len(known)
        rates = [
            (r.job.fraction_done() - r.start_fraction) / r.seconds()
            for r in running
            if r.job.kind == kind and r.job.fraction_done() > r.start_fraction
        ]
        return len(rates) / sum(rates) if rates else self.DEFAULT_S[kind]

    def left(self, waiting, running, parallel):
        """Seconds until all jobs are done, or None."""
        total = 0.0
        for kind in self._seconds:
            mine = [r for r in running if r.job.kind == kind]
            count = sum(1 for job in waiting if job.kind == kind)
            if not mine and count == 0:
                continue
            mean = self.mean(kind, running)
            if mean is None:
                return None
            total += mean * (count + sum(1.0 - r.job.fraction_done() for r in mine))
        return total / parallel


class Runner:
    """Does the missing jobs of a study. A training's evaluations follow as soon as the training is done.

    Each process of the crew (ranks.crew) does `parallel` jobs at the same time.
    """

    def __init__(self, trainings, evaluations, parallel, stream=sys.stdout):
        self._trainings, self._evaluations = trainings, evaluations
        self._crew = ranks.crew()
        # One place for each job that a process does at the same time. All processes get one place before any
        # gets a second one.
        self._places = self._crew.starters() * parallel
        self._stream = stream
        # The terminal of ranks under mpirun has no width.
        self._live = stream.isatty() and os.get_terminal_size(stream.fileno()).columns > 0
        self._last_line = 0.0
        self._stops = 0
        self._estimate = Estimate()
        self._total = self._done = 0
        self.failed = []

    def run(self):
        """Returns True if everything ran, and False if it was interrupted; see also `failed`."""
        conflicts = [text for text in (job.conflict() for job in self._trainings) if text]
        if conflicts:
            raise RuntimeError(conflicts[0])
        finished = {id(job): job.complete() for job in self._trainings}
        waiting = [job for job in self._trainings if not finished[id(job)]]
        evaluations = []
        for job in self._evaluations:
            if job.training is not None and not finished[id(job.training)]:
                evaluations.append(job)
            elif not job.complete():
                evaluations.append(job)
        self._total = len(self._trainings) + len(self._evaluations)
        self._done = self._total - len(waiting) - len(evaluations)
        self._say(
            f"{self._total} jobs, {self._done} already done, {len(waiting)} trainings and "
            f"{len(evaluations)} evaluations to do, {len(self._places)} at a time"
        )
        handlers = heed(self._on_signal)
        try:
            return self._loop(waiting, evaluations, finished)
        finally:
            for number, handler in handlers.items():
                signal.signal(number, handler)

    def _loop(self, trainings, evaluations, finished):
        at_work = {}  # running job by place
        while (trainings or evaluations or at_work) and not self._stops:
            for place, start in enumerate(self._places):
                if place in at_work:
                    continue
                job = self._next(trainings, evaluations, finished)
                if job is None:
                    break
                at_work[place] = start(job)
            if not at_work:
                break  # the remaining jobs wait for trainings that failed
            self._progress(trainings + evaluations, list(at_work.values()))
            self._wait()
            for place, item in list(at_work.items()):
                if item.outcome() is not None:
                    del at_work[place]
                    self._conclude(item, finished)
        if self._stops:
            self._end(list(at_work.values()))
            self._say("stopped; the same command continues from here")
            return False
        for job in evaluations:
            self.failed.append(f"{job.name}: not done, its training failed")
        self._say(self._standing())
        return True

    def _next(self, trainings, evaluations, finished):
        """Takes the next job that can start. Evaluations come first, because they are short."""
        for job in evaluations:
            if job.training is None or finished[id(job.training)]:
                evaluations.remove(job)
                return job
        return trainings.pop(0) if trainings else None

    def _conclude(self, item, finished):
        job, problem = item.job, item.outcome()
        if not problem:
            finished[id(job)] = True
            self._done += 1
            self._estimate.add(job.kind, item.seconds())
            if job.kind == "training":
                self._say(f"done: {job.name} in {duration(item.seconds())}")
            return
        self.failed.append(f"{job.name}: {problem} (log: {job.log})")
        self._say(f"FAILED: {self.failed[-1]}")
        try:
            with open(job.log, encoding="utf-8", errors="replace") as log:
                for line in log.read().splitlines()[-SHOWN_LOG_LINES:]:
                    self._say(f"    | {line}")
        except OSError:
            pass  # it was not started

    def _on_signal(self, number, frame):
        # A terminal that closes may send SIGHUP twice: the terminal itself and its shell.
        self._stops = max(self._stops, 1) if number == signal.SIGHUP else self._stops + 1

    def _wait(self):
        time.sleep(POLL_S)
        if self._crew.listen():
            self._stops = max(self._stops, 1)

    def _end(self, running):
        """Interrupts the processes, which lets trainings save; a second Ctrl-C kills them."""
        if running:
            self._say(f"stopping {len(running)} jobs; trainings save first (a second signal kills them)")
        for item in running:
            item.signal(signal.SIGINT)
        deadline = time.monotonic() + PATIENCE_S
        while any(item.outcome() is None for item in running):
            if self._stops > 1 or time.monotonic() > deadline:
                for item in running:
                    item.signal(signal.SIGKILL)
            self._wait()

    def _standing(self):
        """Number of finished jobs."""
        share = 100 * self._done // self._total if self._total else 100
        return f"{self._done}/{self._total} jobs ({share} %), {len(self.failed)} failed"

    def _progress(self, waiting, running):
        """One line: on a terminal it is updated in place; elsewhere there is a new one every half minute."""
        now = time.monotonic()
        if now - self._last_line < (0.5 if self._live else 30.0):
            return
        self._last_line = now
        left = self._estimate.left(waiting, running, len(self._places))
        parts = [
            f"{r.job.method}/{r.job.seed} {100 * r.job.fraction_done():.0f}%"
            for r in running
            if r.job.kind == "training"
        ]
        text = f"{self._standing()}, ETA " + ("?" if left is None else duration(left))
        if parts:
            text += " | " + ", ".join(parts)
        if self._live:
            width = os.get_terminal_size(self._stream.fileno()).columns - 1
            self._stream.write("\r\x1b[K" + text[: max(width, 20)])
        else:
            self._stream.write(text + "\n")
        self._stream.flush()

    def _say(self, text):
        try:
            self._stream.write(("\r\x1b[K" if self._live else "") + text + "\n")
            self._stream.flush()
        except OSError:
            if not self._stops:
                raise
            # The terminal may be closed, which is the reason for the stop. Trainings must save in any case.
