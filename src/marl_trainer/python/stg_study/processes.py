"""Jobs as processes of this machine."""

import os
import signal
import subprocess
import time

from stg_common.files import FileError, reason_of

# What tells a process that mpirun or srun started it; our jobs are started by us.
LAUNCHERS = ("OMPI_", "PMIX_", "PMI_")


def job_environment():
    """The environment of a job: a program of its own that keeps one core busy."""
    kept = {k: v for k, v in os.environ.items() if not k.startswith(LAUNCHERS)}
    return dict(kept, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")


class Running:
    """A job that has been started, here or elsewhere."""

    def __init__(self, job):
        self.job = job
        self.start = time.monotonic()
        self.start_fraction = job.fraction_done()

    def seconds(self):
        """Since it was started."""
        return time.monotonic() - self.start


class JobProcess(Running):
    """A job whose process runs. It leads its own session, so that Ctrl-C reaches only us, and is
    interrupted when we die, so that no process goes on writing where the job is done again."""

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
        """None while it runs; then what went wrong, nothing where it left all it should."""
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
        """Tells the process and its children, if it still runs."""
        if self._process is not None and self._process.poll() is None:
            try:
                os.killpg(self._process.pid, number)
            except ProcessLookupError:
                pass


def heed(handler):
    """Has `handler` called when this process is asked to stop; the handlers that were there before.

    A hangup that nohup has it ignore stays ignored.
    """
    numbers = [signal.SIGINT, signal.SIGTERM, signal.SIGUSR1]
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        numbers.append(signal.SIGHUP)
    return {number: signal.signal(number, handler) for number in numbers}


class Alone:
    """The one process that carries out jobs where no others help."""

    def starters(self):
        """One function for each process, which starts a job in it and returns what runs."""
        return [JobProcess]

    def listen(self):
        """Hears of the others' jobs; returns whether one of them was asked to stop."""
        return False
