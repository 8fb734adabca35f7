"""The engine reports the features that glibc finds in the processor, whatever /proc/cpuinfo shows."""

import platform
import re
import subprocess
import unittest

import stg
from stg import _processor

LOADER = "/lib64/ld-linux-x86-64.so.2"


@unittest.skipUnless(platform.machine() == "x86_64", "a question to processors of x86-64")
class Processor(unittest.TestCase):
    def test_glibc_says_the_same(self):
        told = subprocess.run([LOADER, "--help"], stdout=subprocess.PIPE, universal_newlines=True, check=True).stdout
        # Every processor gives a line: "x86-64-v3" or "x86-64-v3 (supported, searched)".
        (state,) = re.findall(r"^ +x86-64-v3(.*)$", told, re.MULTILINE)
        self.assertEqual(_processor.X86_64_V3, "supported" in state)

    def test_an_engine_that_runs_is_one_that_the_processor_offers(self):
        if stg.INSTRUCTION_SET == "x86-64-v3":
            self.assertTrue(_processor.X86_64_V3)


if __name__ == "__main__":
    unittest.main()
