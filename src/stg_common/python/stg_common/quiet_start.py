"""Ends a program that is still loading silently when Ctrl-C comes: the first import of such a program.

Python answers a Ctrl-C while it loads with a traceback. A program that is started with the signal
blocked (`env --block-signal=INT`) hears it only after this import, and then ends with status 130.
Where the signal is not blocked, as in a test, this does nothing.
"""

import os
import signal

from stg_common.program import INTERRUPTED

if signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []):
    signal.signal(signal.SIGINT, lambda *_: os._exit(INTERRUPTED))
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
