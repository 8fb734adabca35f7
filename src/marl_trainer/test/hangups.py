"""Programs under test and the signal of a terminal that is closed, SIGHUP."""

import fcntl
import signal
import termios


def takes(terminal):
    """Returns a preexec_fn: the child leads a session on this terminal and obeys its hangup, which
    tests that run under nohup would have it ignore."""

    def take():
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        fcntl.ioctl(terminal, termios.TIOCSCTTY, 0)

    return take


def ignore():
    """A preexec_fn: what nohup does."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)


def ignored_by(pid):
    """Whether a running process ignores them."""
    with open(f"/proc/{pid}/status", encoding="utf-8") as file:
        (ignored,) = [line.split()[1] for line in file if line.startswith("SigIgn:")]
    return bool(int(ignored, 16) >> (signal.SIGHUP - 1) & 1)
