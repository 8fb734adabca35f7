"""Files that are either complete or absent, and folders that only one program at a time writes."""

import contextlib
import errno
import fcntl
import os


def write_atomically(path, content):
    """Writes a file of text or bytes. The file is either complete or absent.

    An OSError has the file's name, even if the disk is full.
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
    """Keeps other programs (also train) out of a folder as long as it is held. OSError if one has the folder.

    The kernel releases the lock when this process ends in any way.
    """
    with open(os.path.join(path, ".lock"), "a", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            reason = "another program is writing into it"
            raise BlockingIOError(errno.EWOULDBLOCK, reason, path) from error
        yield
