"""Files of users are read as a whole, or refused in one line that names file and line."""

import codecs
import gzip
import os
import subprocess
import sys
import tempfile
import unittest

import yaml

from stg_common.csv_files import number, optional, table_rows
from stg_common.files import FileError, expect, read_json, read_text
from stg_common.yaml_files import parse_yaml, read_yaml


class WithFolder(unittest.TestCase):
    """A test with its own folder."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def write(self, content, name="file"):
        """Writes text or bytes into a new file; returns its path."""
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
        return path

    def check_refused(self, read, path, *what):
        """read(path) must raise a FileError with one line that names the file and says `what`."""
        with self.assertRaises(FileError) as caught:
            read(path)
        text = str(caught.exception)
        self.assertTrue(text.startswith(path + ":"), text)
        self.assertEqual(len(text.splitlines()), 1, text)
        for part in what:
            self.assertIn(part, text)


class Files(WithFolder):
    def test_what_is_no_regular_file_is_refused_at_once(self):
        fifo = os.path.join(self.folder, "fifo")
        os.mkfifo(fifo)
        self.check_refused(read_text, fifo, "regular")
        self.check_refused(read_text, "/dev/zero", "regular")
        self.check_refused(read_text, self.folder, "folder")
        self.check_refused(read_text, os.path.join(self.folder, "none"), "No such file")

    def test_sizes_and_bytes_are_limited(self):
        self.check_refused(lambda path: read_text(path, 3), self.write("four"), "4 bytes")
        self.check_refused(read_text, self.write(b"a\nb\xff"), ":2: ", "UTF-8")
        huge = os.path.join(self.folder, "huge")
        with open(huge, "wb") as file:
            file.truncate(1 << 40)
        self.check_refused(read_yaml, huge, "bytes")

    def test_a_byte_order_mark_is_no_part_of_a_text(self):
        mark = codecs.BOM_UTF8
        self.assertEqual(read_text(self.write(mark + b"a")), "a")
        self.assertEqual(read_json(self.write(mark + b'{"a": 1}')), {"a": 1})
        self.assertEqual(read_yaml(self.write(mark + b"a: 1")), {"a": 1})
        for name in ("t.csv", "t.csv.gz"):
            pack = gzip.compress if name.endswith(".gz") else bytes
            rows = table_rows(self.write(pack(mark + b"x,y\n1,2\n"), name), {"x": number})
            self.assertEqual(list(rows), [{"x": 1.0, "y": "2"}])
        self.assertEqual(read_text(self.write(b"a" + mark)), "a\ufeff")  # here it is an ordinary character
        self.check_refused(read_text, self.write(mark + b"a\n\xff"), ":2: ", "UTF-8")
        self.check_refused(read_yaml, self.write(mark + b"a: 1\nb: ["), ":2: ")

    def test_json_is_refused_by_line_and_key(self):
        self.check_refused(read_json, self.write('{\n"a": 1,}'), ":2: ")
        self.check_refused(read_json, self.write("[" * 100000), "deep")
        self.check_refused(read_json, self.write("1" * 5000), "JSON")
        for value, kind in (([], dict), ({}, list), (1, str), ("\ud800", str), ("1", float),
                            (True, float), (float("nan"), float), (10**400, float)):  # fmt: skip
            self.check_refused(lambda path: expect(path, value, kind, "key"), "file", "key: is not")
        self.assertEqual(expect("file", 3, float), 3)


class Yaml(WithFolder):
    def test_a_key_that_stands_twice_is_refused_wherever_it_stands(self):
        for text, line, key in (
            ("a: 1\nb: 2\na: 3\n", 3, "a"),
            ("x:\n  - {a: 1}\n  - {'a': 1,\n     a: 2}\n", 4, "a"),
            ("1: x\n0x1: y\n", 2, "0x1"),
            ("b: &b {x: 1}\nc: {<<: *b, <<: *b}\n", 2, "<<"),
        ):
            self.check_refused(read_yaml, self.write(text), f":{line}: {key}: duplicate key")

    def test_what_safe_load_reads_is_read_alike(self):
        text = (
            "base: &base {lr: 1.0e-3, deep: [1, [2, {x: ~}]]}\n"
            "mine: {<<: *base, lr: 0.5}\nagain: {<<: [*base, {n: 2}], '1': a, 1: b}\n"
            "day: 2026-11-22\nyes: on\n"
        )
        self.assertEqual(parse_yaml(text, "text"), yaml.safe_load(text))
        self.assertIsNone(parse_yaml("", "text"))

    def test_what_makes_the_reader_stumble_is_refused_by_line(self):
        laughs = "a0: &a0 [1, 1]\n" + "".join(
            f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]\n" for k in range(1, 9)
        )
        for text, line in (
            ("a: 1\nb: [", 2),
            ("a: 1\nb: " + "[" * 5000, 2),
            ("a: 1\nb: 2026-99-99", 2),
            ("a: 1\nb: !!int ''", 2),
            ("a: 1\nb: !!python/none x", 2),
            ("a: 1\nb: " + "9" * 5000, 2),
            ("a: 1\nb: 0x" + "f" * 5000, 2),
            ("a: 1\n? [1]\n: 2", 2),
            ("a: 1\nb: *c", 2),
            ("a: 1\nb: &c [*c]", 2),
            ('a: 1\nb: "\\ud800"', 2),
            ('a: 1\nb: "\\0"', 2),
            ("a: 1\nb: \x01", 2),
            (laughs, 7),
        ):
            self.check_refused(read_yaml, self.write(text), f":{line}: ")


class Tables(WithFolder):
    def rows(self, path):
        return list(table_rows(path, {"name": str, "x": number}, lambda name: optional(number)))

    def test_cells_are_what_their_columns_are(self):
        text = 'name,x,y\n"a,b",1,\nc,2,3\n'
        expected = [{"name": "a,b", "x": 1.0, "y": None}, {"name": "c", "x": 2.0, "y": 3.0}]
        self.assertEqual(self.rows(self.write(text)), expected)
        self.assertEqual(self.rows(self.write(gzip.compress(text.encode()), "t.gz")), expected)

    def test_damage_is_refused_by_line(self):
        for text, what in (
            ("name,y\n", ":1: no column x"),
            ("", ":1: no column name, x"),
            ("name,x,x\n", ":1: more than one column x"),
            ("name,x\na,1\nb\n", ":3: 1 cells"),
            ("name,x\na,1,2\n", ":2: 3 cells"),
            ("name,x\na,many\n", ":2: x: 'many'"),
            ("name,x\na,\n", ":2: x: ''"),
            ("name,x\na,nan\n", ":2: x: 'nan'"),
            ("name,x\na,1e300\n", ":2: x: "),
            (b"name,x\n\xff,1\n", ":2: is not text"),
            ("name,x\n" + "a" * 200000 + ",1\n", ":2: "),
            ("name,x\n" + "a" * 2000000, ":2: a line of more"),
        ):
            self.check_refused(self.rows, self.write(text), what)

    def test_damaged_compression_is_refused(self):
        whole = gzip.compress(b"name,x\n" + b"".join(b"a%d,%d\n" % (k, k * k) for k in range(9999)))
        for data in (whole[:5000], whole[:5], whole[:3000] + bytes(9) + whole[3009:], b"name,x\n"):
            self.check_refused(self.rows, self.write(data, "t.csv.gz"), "damaged")


class Program(WithFolder):
    def run_with(self, body, **options):
        """Runs a program whose main() is `body`."""
        text = f"import sys\nfrom stg_common import program, files\ndef main():\n    {body}\n"
        text += "program.run_program('name', main)\n"
        return subprocess.run([sys.executable, "-c", text], stderr=subprocess.PIPE,
                              universal_newlines=True, check=False, **options)  # fmt: skip

    def test_files_at_fault_end_it_in_one_line(self):
        for body in ("files.read_text('a\\nb')", "open('a\\nb')"):
            run = self.run_with(body)
            self.assertEqual((run.returncode, run.stderr), (2, "name: a\\nb: No such file or directory\n"))

    def test_a_closed_pipe_ends_it_silently(self):
        for body in ("print(1)", "[print(k) for k in range(99999)]"):
            reader, writer = os.pipe()
            os.close(reader)
            run = self.run_with(body, stdout=writer)
            os.close(writer)
            self.assertEqual((run.returncode, run.stderr), (141, ""))

    def test_an_interrupt_ends_it_silently(self):
        # The tests may have been started with interrupts ignored, as `&` in a script does.
        run = self.run_with(
            "import os, signal, time; signal.signal(signal.SIGINT, signal.default_int_handler); "
            "os.kill(os.getpid(), signal.SIGINT); time.sleep(9)"
        )
        self.assertEqual((run.returncode, run.stderr), (130, ""))


if __name__ == "__main__":
    unittest.main()
