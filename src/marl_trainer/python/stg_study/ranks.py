"""Jobs on the MPI processes of one mpirun: rank 0 plans and reports, and all ranks do jobs.

All ranks have access to the same folders, as on a cluster. The rank that does a job writes all of its files,
and reports the result to rank 0.
"""

import functools
import os
import socket
import time
import traceback

from stg_study.processes import Alone, JobProcess, Running, heed

POLL_S = 0.05
START, SIGNAL, END, DONE, STOP = range(5)  # kinds of messages

_crew = Alone()


def crew():
    """The crew that does the jobs of this command."""
    return _crew


def default_jobs():
    """Number of simultaneous jobs of a process: one for each core, or one if there are other ranks."""
    return 1 if started_by_mpi() else os.cpu_count() or 1


def started_by_mpi():
    """True if mpirun or srun has started this process."""
    # The same test as in the train command.
    return any(name in os.environ for name in ("OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"))


def led(main, argv):
    """Runs main(argv) in rank 0 or in the only process. The other ranks do jobs for rank 0."""
    global _crew
    if not started_by_mpi():
        return main(argv)
    try:
        from mpi4py import MPI  # the import starts MPI
    except ImportError as error:
        raise RuntimeError("started by mpirun: needs python3-mpi4py") from error
    if MPI.COMM_WORLD.rank != 0:
        return _Helper(MPI.COMM_WORLD).serve()
    _crew = _Leader(MPI.COMM_WORLD)
    try:
        return main(argv)
    finally:
        _crew.dismiss()


class _Elsewhere(Running):
    """A job that another rank does."""

    def __init__(self, comm, rank, jobs, job):
        super().__init__(job)
        self._outcome = None
        self._tell = functools.partial(comm.send, dest=rank)
        self._key = len(jobs)
        jobs.append(self)
        self._tell((START, self._key, job))

    def outcome(self):
        """See JobProcess."""
        return self._outcome

    def conclude(self, outcome):
        """Stores the report of the other rank."""
        self._outcome = outcome

    def signal(self, number):
        """See JobProcess."""
        if self._outcome is None:
            self._tell((SIGNAL, self._key, number))


class _Leader(Alone):
    """Rank 0."""

    def __init__(self, comm):
        self._comm = comm
        self._jobs = []  # all jobs that were given to others

    def starters(self):
        others = range(1, self._comm.size)
        start = [functools.partial(_Elsewhere, self._comm, r, self._jobs) for r in others]
        return [JobProcess, *start]

    def listen(self):
        asked = False
        while self._comm.iprobe():
            kind, *content = self._comm.recv()
            if kind == DONE:
                key, outcome = content
                self._jobs[key].conclude(outcome)
            asked = asked or kind == STOP
        return asked

    def dismiss(self):
        """Ends the other ranks."""
        for rank in range(1, self._comm.size):
            self._comm.send((END,), dest=rank)


class _Helper:
    """Any other rank."""

    def __init__(self, comm):
        self._comm = comm
        self._running = {}
        self._asked = False

    def _on_signal(self, number, frame):
        self._asked = True

    def serve(self):
        """Does jobs until rank 0 ends it. Returns 0."""
        heed(self._on_signal)  # rank 0 decides which jobs are interrupted, and when
        try:
            while self._obey():
                self._report()
                time.sleep(POLL_S)
        except Exception:  # after any error, the others must not wait for this rank
            traceback.print_exc()
            self._comm.Abort(1)
        return 0

    def _obey(self):
        while self._comm.iprobe(source=0):
            kind, *content = self._comm.recv(source=0)
            if kind == END:
                return False
            key, what = content
            if kind == START:
                self._running[key] = JobProcess(what)
            elif key in self._running:
                self._running[key].signal(what)
        return True

    def _report(self):
        for key, process in list(self._running.items()):
            outcome = process.outcome()
            if outcome is None:
                continue
            where = f", on {socket.gethostname()}" if outcome else ""
            self._comm.send((DONE, key, outcome + where), dest=0)
            del self._running[key]
        if self._asked:
            self._asked = False
            self._comm.send((STOP,), dest=0)
