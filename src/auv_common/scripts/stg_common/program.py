"""How a program of this repository ends: in one line where a file is at fault, silently where
nobody reads on."""

import os
import signal
import sys

from stg_common.files import FileError, one_line

NOBODY_READS = 128 + signal.SIGPIPE  # the exit status that a shell gives programs which SIGPIPE ended


def run_program(name, main, *refusals, status=2):
    """Ends the process with what main() returns; with `status`, and one line, where it throws
    FileError, another of the `refusals`, or OSError, such as of a folder that is closed to us."""
    try:
        code = main()
        sys.stdout.flush()
    except BrokenPipeError:
        # What is still to be written when Python ends goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = NOBODY_READS
    except (FileError, *refusals) as error:
        code = _refuse(name, error, status)
    except OSError as error:
        place = "" if error.filename is None else f"{error.filename}: "
        code = _refuse(name, f"{place}{error.strerror or error}", status)
    sys.exit(code)


def _refuse(name, what, status):
    print(f"{name}: {one_line(what)}", file=sys.stderr)
    return status
