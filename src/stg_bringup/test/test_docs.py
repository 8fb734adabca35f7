"""Checks what the documentation says about the code: equations, links, topics."""

import pathlib
import re
import subprocess
import unittest

from stg_common.loading import load_program

ROOT = pathlib.Path(__file__).resolve().parents[3]
SOURCES = ROOT / "src"
DOCS = ROOT / "docs"
PACKAGES = (
    "acoustic_channel",
    "auv_common",
    "auv_dynamics",
    "marl_trainer",
    "stg_agent",
    "stg_bringup",
    "stg_env",
    "stg_monitor",
    "stg_python",
)
tree = load_program(ROOT / "scripts" / "lint" / "tree.py")


def named_sources():
    """Returns {name: path} of the C++ files. Pages name headers and sources as an #include does:
    `auv_dynamics/world/world.cpp`."""
    return {str(tree.logical(path)): SOURCES / path for path in tree.cpp_files(SOURCES)}


def equation_rows():
    """Returns [(equation, file, name)] of the table in docs/equations.md."""
    rows = []
    for line in (DOCS / "equations.md").read_text().splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if re.fullmatch(r"\(\d+\)|Algorithm S\d", cells[0]):
            rows.append((cells[0], cells[2].strip("`"), cells[3].strip("`")))
    return rows


class Equations(unittest.TestCase):
    """The table from the paper's equations to the code is complete and true."""

    def test_every_equation_of_the_paper_has_a_row(self):
        named = {equation for equation, _, _ in equation_rows()}
        wanted = {f"({n})" for n in range(1, 45)} | {"Algorithm S1", "Algorithm S2"}
        self.assertEqual(named, wanted)

    @staticmethod
    def declaration(name):
        """Returns a pattern that finds the declaration of a type, a function, a member or an enumerator."""
        if re.match(r"k[A-Z]", name):
            return rf"\b{name}\b *[,}}=]"
        kind = rf"\b(?:class|struct|using|enum class) {name}\b"
        typed = rf"^(?! *return\b)[^=(;\n]*[\w>&*] +(?:[\w<>]+::)*{name} *[(=;{{]"
        return f"{kind}|{typed}"

    def test_every_file_exists_and_declares_the_name(self):
        for equation, path, name in equation_rows():
            with self.subTest(equation):
                self.assertTrue(path in named_sources(), f"{path} does not exist")
                code = re.sub(r"//.*", "", named_sources()[path].read_text())
                found = re.search(self.declaration(name), code, re.MULTILINE)
                self.assertTrue(found, f"{path} does not declare {name}")

    def test_a_use_is_no_declaration(self):
        uses = "  Reward(k);\n  return Reward(k);\n  x = Reward(k);\n  if (Reward(k) > 0) {\n  Add(Reward)"
        self.assertIsNone(re.search(self.declaration("Reward"), uses, re.MULTILINE))
        for text in (
            "class Reward {",
            "inline T Reward(const T& x)",
            "void World<T>::Reward()",
            "  double Reward = 0.9;",
            "  std::vector<T> Reward(int n) const;",
        ):
            self.assertIsNotNone(re.search(self.declaration("Reward"), text, re.MULTILINE), text)


class Diffs(unittest.TestCase):
    """The page that shows what a new thing changes fits the sources of today."""

    page = DOCS / "how_to" / "in_this_repository.md"

    def test_every_registry_has_a_section(self):
        headers = "".join(path.read_text() for path in SOURCES.glob("*/include/**/*.hpp"))
        registries = re.findall(r"^using (\w+) = Registry<", headers, re.M)
        self.assertGreater(len(registries), 10)
        shown = re.findall(r"^\+ +STG_ENTRY\((\w+), \w+\)", self.page.read_text(), re.M)
        self.assertEqual(sorted(shown), sorted(registries))

    def test_every_diff_applies(self):
        for section in self.page.read_text().split("\n## ")[1:]:
            with self.subTest(section.splitlines()[0]):
                diff = re.search(r"```diff\n(.*?)```", section, re.S).group(1)
                done = subprocess.run(
                    ["git", "apply", "--check", "-"],
                    cwd=ROOT, input=diff, text=True, stderr=subprocess.PIPE, check=False,
                )  # fmt: skip
                self.assertEqual(done.returncode, 0, done.stderr)
                added = re.findall(r"^\+ +(.*)$", diff, re.M)
                self.assertEqual(len(added), 1, "one line in the registry")
                entry = re.search(r"STG_ENTRY\((\w+), (\w+)\)", added[0])
                self.assertIn(f"{entry.group(1)}::Entry {entry.group(2)}() {{ return", section)
                folder = re.search(r"in the folder\s+`(src/\w+)/src/\w+", section).group(1)
                build = (ROOT / folder / "CMakeLists.txt").read_text()
                self.assertIn("stg_core_sources(", build, "the build finds the file")
                factory = re.search(r"return \{\"\w+\", (.*)\}; \}", section).group(1)
                example = re.search(r"\((\S+\.cpp)\)", section).group(1)
                self.assertIn(factory, (self.page.parent / example).read_text())


class Links(unittest.TestCase):
    """Links between pages and to pictures lead somewhere."""

    def test_every_relative_link_exists(self):
        pages = [*ROOT.glob("*.md"), *DOCS.rglob("*.md")]
        self.assertGreater(len(pages), 10)
        for page in pages:
            for target in re.findall(r"\]\(([^)#\s]+)", page.read_text()):
                if not re.match(r"[a-z]+:", target):
                    self.assertTrue((page.parent / target).exists(), f"{page.name}: {target}")


class Sources(unittest.TestCase):
    """Sources that the pages name exist."""

    def test_every_source_named_on_a_page_exists(self):
        sources = named_sources()
        places = set(sources) | {str(path.relative_to(SOURCES)) for path in sources.values()}
        # Tables name the files of one package without the first folders.
        ends = {"/".join(place.split("/")[-n:]) for place in places for n in (1, 2, 3)}
        examples = {str(path.relative_to(ROOT)) for path in (ROOT / "examples").rglob("*.cpp")}
        found = 0
        for page in [*ROOT.glob("*.md"), *DOCS.rglob("*.md")]:
            if page.name != "CHANGELOG.md":
                for name in re.findall(r"`(?:src/)?((?:\w+/)*\w+\.[ch]pp)`", page.read_text()):
                    found += 1
                    known = places if name.split("/")[0] in PACKAGES else ends | examples
                    with self.subTest(name):
                        self.assertTrue(name in known, f"{page.name}: {name} does not exist")
        self.assertGreater(found, 100)


class HowTo(unittest.TestCase):
    """Each kind of thing that can be added has an example that is compiled and tested."""

    THINGS = (
        "vehicle",
        "propagation_model",
        "medium_access",
        "target_motion",
        "sensor",
        "controller",
        "algorithm",
        "reward_term",
    )
    # Their examples. The page of all diffs shows them.
    WITHOUT_PAGE = {
        "autopilot": "vehicle/unicycle.cpp",
        "localizer": "localizer/forecast.cpp",
        "modem_profile": "modem_profile/slow_fsk.cpp",
        "navigation_system": "navigation_system/tracked.cpp",
        "target_filter": "target_filter/last_seen.cpp",
    }

    def pages(self):
        """Yields (thing, its page, the path of its example from docs/how_to)."""
        for thing in self.THINGS:
            article = "an" if thing[0] in "aeiou" else "a"
            (example,) = (ROOT / "examples" / thing).glob("*.cpp")
            yield thing, f"add_{article}_{thing}.md", f"../../examples/{thing}/{example.name}"

    def test_every_thing_is_in_the_index_and_its_example_in_the_build(self):
        index = (DOCS / "how_to" / "README.md").read_text()
        build = (ROOT / "examples" / "CMakeLists.txt").read_text()
        for thing, page, example in self.pages():
            with self.subTest(thing):
                self.assertTrue(f"({page})" in index, page)
                self.assertTrue(f"({example})" in index, example)
                self.assertTrue(f"({example})" in (DOCS / "how_to" / page).read_text(), page)
                self.assertTrue(f"  {example.partition('examples/')[2]}\n" in build, example)

    def test_a_thing_without_a_page_is_in_the_index_and_its_diff_is_shown(self):
        index = (DOCS / "how_to" / "README.md").read_text()
        diffs = (DOCS / "how_to" / "in_this_repository.md").read_text()
        build = (ROOT / "examples" / "CMakeLists.txt").read_text()
        for thing, example in self.WITHOUT_PAGE.items():
            with self.subTest(thing):
                title = ("An " if thing[0] in "aeiou" else "A ") + thing.replace("_", " ")
                anchor = title.lower().replace(" ", "-")
                self.assertTrue(f"\n## {title}\n" in diffs, title)
                self.assertTrue(f"(in_this_repository.md#{anchor})" in index, anchor)
                for text in (index, diffs):
                    self.assertTrue(f"(../../examples/{example})" in text, example)
                self.assertTrue(f"  {example}\n" in build, example)

    def test_the_pages_are_alike(self):
        for _, page, _ in self.pages():
            text = (DOCS / "how_to" / page).read_text()
            heads = re.findall(r"^## (\d\. \w+ \w+)", text, re.MULTILINE)
            heads = [re.sub("constants", "keys", head) for head in heads]
            wanted = ["1. The interface", "2. The file", "3. The line", "4. Its keys", "5. What to"]
            self.assertEqual(heads, wanted, page)

    @staticmethod
    def words(code):
        """Returns C++ text without comments, its white space folded."""
        return " ".join(re.sub(r"//.*", "", code).split())

    def test_what_a_page_quotes_first_stands_in_its_example(self):
        for _, page, example in self.pages():
            code = self.words((DOCS / "how_to" / example).read_text())
            blocks = re.findall(r"```cpp\n(.*?)```", (DOCS / "how_to" / page).read_text(), re.S)
            self.assertTrue(blocks, page)
            for part in re.split(r"\n\s*(?:// ?)?\.\.\.\n", blocks[0]):
                with self.subTest(page):
                    self.assertTrue(self.words(part) in code, f"{page}: {part}")


class PackagePages(unittest.TestCase):
    """Each package has a page, and the page names what its nodes use."""

    def constants(self, package):
        """Returns the names of topics and services of a package, from the headers that define them."""
        text = ""
        for header in (SOURCES / package / "src" / "nodes").rglob("topics.hpp"):
            text += header.read_text().partition("namespace stg::frames")[0]
        return set(re.findall(r'constexpr char k\w+\[\] = "([\w/]+)"', text))

    def test_every_package_has_a_page_with_its_topics_and_services(self):
        self.assertGreater(len(set().union(*map(self.constants, PACKAGES))), 10)
        for package in PACKAGES:
            with self.subTest(package):
                # The metrics node of stg_monitor publishes some topics that auv_dynamics names.
                pages = {package, "stg_monitor"}
                text = "".join((DOCS / "packages" / f"{page}.md").read_text() for page in pages)
                for name in self.constants(package):
                    whole_name = rf"(?<!\w){re.escape(name)}(?!\w)"
                    self.assertTrue(re.search(whole_name, text), f"{name} is not on the page")

    def test_every_private_parameter_of_a_node_is_on_its_page(self):
        pattern = re.compile(
            r'(?:Text|Flag|Number|Integer)Parameter\(\s*"(\w+)"|private_nh_\.param\("([\w/]+)"'
        )
        found = 0
        for package in PACKAGES:
            text = (DOCS / "packages" / f"{package}.md").read_text()
            for source in sorted((SOURCES / package / "src" / "nodes").rglob("*.cpp")):
                for match in pattern.finditer(source.read_text()):
                    name = match.group(1) or match.group(2)
                    found += 1
                    self.assertTrue(
                        f"`{name}`" in text, f"{source.name}: {name} is not on the page"
                    )
        self.assertGreater(found, 20)


if __name__ == "__main__":
    unittest.main()
