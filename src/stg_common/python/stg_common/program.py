"""The end of a program in this repository. It reports a wrong file in one line. It ends silently if nothing
reads its output any more, or after Ctrl-C."""

import io
import os
import signal
import sys

from stg_common.files import FileError, one_line, reason_of

# Exit statuses that a shell gives to programs that these signals ended.
NOBODY_READS = 128 + signal.SIGPIPE
INTERRUPTED = 128 + signal.SIGINT


def discard(stream):
    """Discards everything that is written to a stream from now on."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


class Unread(io.TextIOWrapper):
    """A standard stream that raises nothing when its reader disappears. It then calls when_unread() once, in
    the thread that noticed it, and discards the rest."""

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
    """Ends the process with the result of main(). If main() raises FileError or another error in `refusals`,
    it prints one line and uses the exit status `status`. For OSError, such as a forbidden folder or a full
    disk, it uses `system_status` (default: `status`). After Ctrl-C it ends silently."""
    try:
        code = main()
        sys.stdout.flush()
    except BrokenPipeError:
        discard(sys.stdout)  # Python flushes it at the end
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
