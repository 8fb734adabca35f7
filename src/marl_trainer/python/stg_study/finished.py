"""Results of finished jobs in a file of the output folder, so that a search can go on on another machine."""

import json
import os

from stg_common.files import expect, member, read_json
from stg_study.files import write_atomically


class Finished:
    """Numbers of finished jobs by command line. The folder of the runs (work) is not needed for them.

    The file does not know the version of the programs. Delete it after a change of what they compute.
    """

    NAME = "finished.json"

    def __init__(self, folder):
        self._path = os.path.join(folder, self.NAME)
        self._results = read_json(self._path) if os.path.exists(self._path) else {}
        expect(self._path, self._results, dict)
        for command, numbers in self._results.items():
            expect(self._path, numbers, dict, command)
            for name in numbers:
                member(self._path, numbers, name, float)

    def find(self, arguments):
        """The numbers {name: value} of the job with these arguments, or None if it is not finished."""
        return self._results.get(" ".join(arguments))

    def add(self, arguments, numbers):
        """Keeps the numbers of a job. The file is written at once."""
        self._results[" ".join(arguments)] = numbers
        text = json.dumps(self._results, indent=0, sort_keys=True)
        write_atomically(self._path, text + "\n")
