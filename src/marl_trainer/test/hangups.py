"""Programs under test, and SIGHUP, the signal of a terminal that is closed."""

import fcntl
import signal
import termios


def takes(terminal):
    """Returns a preexec_fn. With it the child leads a session on this terminal and obeys its hangup, which it
    would ignore in tests that run under nohup."""

    def take():
        signal.signal(signal.SIGHUP, signal.SIG_DFL)
        fcntl.ioctl(terminal, termios.TIOCSCTTY, 0)

    return take


def ignore():
    """A preexec_fn that ignores hangups, as nohup does."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)


def ignored_by(pid):
    """Tells whether a running process ignores hangups."""
    with open(f"/proc/{pid}/status", encoding="utf-8") as file:
        (ignored,) = [line.split()[1] for line in file if line.startswith("SigIgn:")]
    return bool(int(ignored, 16) >> (signal.SIGHUP - 1) & 1)
