"""How a program of this repository ends: in one line where a file is at fault, silently where
the output has no reader any more or Ctrl-C was pressed."""

import io
import os
import signal
import sys

from stg_common.files import FileError, one_line, reason_of

# The exit statuses that a shell gives programs which these signals ended.
NOBODY_READS = 128 + signal.SIGPIPE
INTERRUPTED = 128 + signal.SIGINT


def discard(stream):
    """Sends what is still written to a stream nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


class Unread(io.TextIOWrapper):
    """A standard stream that throws nothing when its reader leaves: when_unread() is called once, in
    the thread that found it out, and the rest goes nowhere."""

    def __init__(self, stream, when_unread):
        super().__init__(stream.buffer, stream.encoding, stream.errors, line_buffering=True)
        self._when_unread = when_unread

    def write(self, text):
        try:
            return super().write(text)
        except BrokenPipeError:
            self._give_up()
            return len(text)

    def flush(self):
        try:
            super().flush()
        except BrokenPipeError:
            self._give_up()

    def _give_up(self):
        discard(self)
        self._when_unread()


def run_program(name, main, *refusals, status=2, system_status=None):
    """Ends the process with what main() returns; with `status`, and one line, where it throws
    FileError or another of the `refusals`; with `system_status`, the same by default, where it is
    OSError, such as of a folder that is closed to us or a disk that is full; after Ctrl-C silently."""
    try:
        code = main()
        sys.stdout.flush()
    except BrokenPipeError:
        discard(sys.stdout)  # which Python flushes when it ends
        code = NOBODY_READS
    except KeyboardInterrupt:
        code = INTERRUPTED
    except (FileError, *refusals) as error:
        code = _refuse(name, error, status)
    except OSError as error:
        code = _refuse(name, reason_of(error), status if system_status is None else system_status)
    sys.exit(code)


def _refuse(name, what, status):
    print(f"{name}: {one_line(what)}", file=sys.stderr)
    return status
