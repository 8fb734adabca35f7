"""Files that are whole or not there, and folders that one program at a time writes into."""

import contextlib
import errno
import fcntl
import os


def write_atomically(path, content):
    """Writes a file, of text or bytes, that exists either whole or not at all.

    An OSError has the file's name, also where the disk is full.
    """
    temporary = f"{path}.{os.getpid()}.part"
    try:
        with open(temporary, "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
        os.replace(temporary, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.remove(temporary)
        raise OSError(error.errno, error.strerror, path) from error


@contextlib.contextmanager
def locked(path):
    """Keeps other programs, train among them, out of a folder meanwhile; OSError when one has it.

    The kernel lets go of the lock however this process ends.
    """
    with open(os.path.join(path, ".lock"), "a", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            reason = "another program is writing into it"
            raise BlockingIOError(errno.EWOULDBLOCK, reason, path) from error
        yield
