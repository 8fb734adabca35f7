"""Jobs as processes of this machine."""

import os
import signal
import subprocess
import time

from stg_common.files import FileError, reason_of

# Variables that show a process that mpirun or srun started it; they must not reach our jobs.
LAUNCHERS = ("OMPI_", "PMIX_", "PMI_")


def job_environment():
    """The environment of a job: a separate program that uses one core."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(LAUNCHERS)}
    return dict(kept, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")


class Running:
    """A job that has been started, here or elsewhere."""

    def __init__(self, job):
        self.job = job
        self.start = time.monotonic()
        self.start_fraction = job.fraction_done()

    def seconds(self):
        """Time since the start [s]."""
        return time.monotonic() - self.start


class JobProcess(Running):
    """A job in a running process. It leads its own session, so that Ctrl-C only reaches this program. It is
    interrupted when this program ends, so that no process writes where the job is done again."""

    def __init__(self, job):
        super().__init__(job)
        self._outcome = None
        self._process = None
        try:
            command = job.prepare()
            os.makedirs(os.path.dirname(job.log), exist_ok=True)
            with open(job.log, "wb") as log:
                self._process = subprocess.Popen(
                    ["setpriv", "--pdeathsig", "INT", *command],
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=subprocess.STDOUT,
                    env=job_environment(),
                    start_new_session=True,
                )
        except OSError as error:
            self._outcome = f"it cannot be started: {reason_of(error)}"

    def outcome(self):
        """None while it runs; then the error, or an empty text if all results exist."""
        if self._outcome is None and self._process.poll() is not None:
            self._outcome = self._conclude(self._process.returncode)
        return self._outcome

    def _conclude(self, status):
        if status != 0:
            return f"exit status {status}"
        try:
            with open(self.job.log, encoding="utf-8", errors="replace") as log:
                self.job.finish(log.read())
            return "" if self.job.complete() else "its output is incomplete"
        except (FileError, OSError, ValueError, IndexError) as error:
            return f"its output cannot be read: {reason_of(error)}"

    def signal(self, number):
        """Sends a signal to the process and its children, if it still runs."""
        if self._process is not None and self._process.poll() is None:
            try:
                os.killpg(self._process.pid, number)
            except ProcessLookupError:
                pass


def heed(handler):
    """Calls `handler` when this process is asked to stop. Returns the previous handlers.

    A SIGHUP that is ignored because of nohup stays ignored.
    """
    numbers = [signal.SIGINT, signal.SIGTERM, signal.SIGUSR1]
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        numbers.append(signal.SIGHUP)
    return {number: signal.signal(number, handler) for number in numbers}


class Alone:
    """The only process that does jobs, if there are no others."""

    def starters(self):
        """One function for each process. It starts a job in the process and returns the running job."""
        return [JobProcess]

    def listen(self):
        """Receives reports about jobs of others. Returns True if one of them was asked to stop."""
        return False
