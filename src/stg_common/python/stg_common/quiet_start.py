"""Ends a program silently if Ctrl-C comes while it is loading. It must be the first import of the program.

Python answers a Ctrl-C during loading with a traceback. A program that is started with the signal blocked
(`env --block-signal=INT`) receives it only after this import, and then ends with status 130. If the signal is
not blocked, as in a test, this does nothing.
"""

import os
import signal

from stg_common.program import INTERRUPTED

if signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, []):
    signal.signal(signal.SIGINT, lambda *_: os._exit(INTERRUPTED))
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])
