# Long because: one class for each rule of the house.
"""Checks the rules of the house: the code keeps each of them, and a test can break each of them."""

import pathlib
import subprocess
import tempfile
import unittest

from stg_common.loading import load_program

ROOT = pathlib.Path(__file__).resolve().parents[3]
house = load_program(ROOT / "scripts" / "lint" / "house.py")
words = load_program(ROOT / "scripts" / "lint" / "words.py")

TOPICS = "auv_dynamics/src/nodes/include/auv_dynamics/nodes/topics.hpp"
REGISTRY = """
MotionRegistry& TargetMotions() {
  static MotionRegistry registry("target motion", {
      {"straight", MakeStraight},
      {"evasive", [](const TargetConfig& c) { return MakeEvasive(c); }},
  });
  return registry;
}
"""


class Rule(unittest.TestCase):
    """A rule, for the code of this repository and for small trees that keep or break it."""

    check = None

    def findings(self, files):
        """Returns the findings of the rule in a tree of {path from src/: text}."""
        with tempfile.TemporaryDirectory() as folder:
            for path, text in files.items():
                file = pathlib.Path(folder, path)
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(text)
            return type(self).check(pathlib.Path(folder))[1]

    def assert_clean(self, files):
        """Fails if the rule finds anything in the tree."""
        self.assertEqual(self.findings(files), [])

    def assert_found(self, files, *words):
        """Fails unless the rule finds exactly one thing in the tree and its line has all the words."""
        found = self.findings(files)
        self.assertEqual(len(found), 1, found)
        for word in words:
            self.assertIn(word, found[0])


def on_the_code(rule):
    """Adds a test to a Rule: this repository keeps it."""

    def test_the_code_keeps_it(self):
        looked_at, found = type(self).check()
        self.assertFalse(found, f"\n{looked_at}:\n" + "\n".join(found))

    rule.test_the_code_keeps_it = test_the_code_keeps_it
    return rule


@on_the_code
class Includes(Rule):
    """Dependencies between packages go one way, and cores know neither ROS nor messages."""

    check = house.check_includes

    def test_lower_packages_and_the_own_one_may_be_included(self):
        self.assert_clean(
            {
                "stg_agent/src/agent/agent.cpp": '#include "stg_agent/agent/agent.hpp"\n'
                '#include "auv_dynamics/world/world.hpp"\n'
                '#include "acoustic_channel/channel/channel.hpp"\n'
                "#include <cmath>\n",
                "stg_monitor/src/nodes/metrics.cpp": '#include "stg_env/env/env.hpp"\n',
            }
        )

    def test_a_higher_package_is_found_in_headers_sources_nodes_and_tests(self):
        line = '#include "stg_agent/agent/agent.hpp"\n'
        for path in (
            "auv_dynamics/include/auv_dynamics/world/world.hpp",
            "auv_dynamics/src/world/world.cpp",
            "auv_dynamics/src/nodes/world_node.cpp",
            "auv_dynamics/test/world_test.cpp",
        ):
            self.assert_found({path: "\n" + line}, f"src/{path}:2:", "stg_agent")

    def test_channel_and_vehicles_do_not_know_each_other(self):
        for ours, theirs in (("acoustic_channel", "auv_dynamics"), ("auv_dynamics", "acoustic_channel")):
            self.assert_found({f"{ours}/src/a.cpp": f'# include "{theirs}/b.hpp"\n'}, theirs)

    def test_ros_and_messages_are_for_nodes_alone(self):
        for header in ("<ros/time.h>", '"auv_msgs/SensorFrame.h"', '"auv_common/nodes/health.hpp"'):
            text = f"#include {header}\n"
            self.assert_found({"auv_dynamics/include/auv_dynamics/a.hpp": text}, "ROS")
            self.assert_clean({"auv_dynamics/src/nodes/main.cpp": text})
        self.assert_clean({"auv_dynamics/src/a.cpp": "#include <rosy/ros.h>\n"})


@on_the_code
class Circles(Rule):
    """Folders of one parent do not include each other in circles."""

    check = house.check_circles

    def include(self, header):
        """Returns the line that includes a header of auv_dynamics."""
        return f'#include "auv_dynamics/{header}"\n'

    def test_a_chain_and_common_ground_are_no_circle(self):
        self.assert_clean(
            {
                "auv_dynamics/include/auv_dynamics/world/world.hpp": self.include("vehicle/a.hpp"),
                "auv_dynamics/include/auv_dynamics/vehicle/a.hpp": self.include("config.hpp"),
                "auv_dynamics/include/auv_dynamics/config.hpp": self.include("vehicle/b.hpp"),
            }
        )

    def test_two_folders_and_three_folders_are_found(self):
        vehicle = "auv_dynamics/include/auv_dynamics/vehicle/a.hpp"
        world = "auv_dynamics/src/world/world.cpp"
        self.assert_found(
            {vehicle: self.include("world/b.hpp"), world: self.include("vehicle/a.hpp")},
            "vehicle -> world -> vehicle",
            f"src/{vehicle}:1",
            f"src/{world}:1",
        )
        control = "auv_dynamics/src/control/c.cpp"
        self.assert_found(
            {
                vehicle: self.include("world/b.hpp"),
                world: self.include("control/c.hpp"),
                control: self.include("vehicle/a.hpp"),
            },
            "control -> vehicle -> world -> control",
        )

    def test_folders_within_folders_are_found(self):
        learn = "marl_trainer/include/marl_trainer/learn"
        self.assert_found(
            {
                f"{learn}/nn/mlp.hpp": '#include "marl_trainer/learn/buffers/b.hpp"\n',
                f"{learn}/buffers/b.hpp": '#include "marl_trainer/learn/nn/mlp.hpp"\n',
            },
            "marl_trainer/learn: buffers -> nn -> buffers",
        )


@on_the_code
class Sizes(Rule):
    """Files and folders stay small enough to read."""

    check = house.check_sizes

    def test_a_long_file_needs_a_reason_in_its_head(self):
        for path, mark in (("p/src/a.cpp", "//"), ("p/scripts/a.py", "#")):
            line = f"{mark} x\n"
            reason = f"{mark} Long because: one table.\n"
            self.assert_clean({path: line * 350})
            self.assert_found({path: line * 351}, f"src/{path}", "351")
            self.assert_clean({path: reason + line * 350})
            self.assert_found({path: line * 351 + reason}, f"src/{path}")
            self.assert_found({path: f"{mark} Long because: \n" + line * 350}, f"src/{path}")

    def test_a_folder_holds_a_dozen_sources(self):
        files = {f"p/src/a/{i}.cpp": "\n" for i in range(12)}
        self.assert_clean({**files, "p/src/a/notes.txt": "", "p/src/a/b/13.hpp": "\n"})
        self.assert_found({**files, "p/src/a/13.hpp": "\n"}, "src/p/src/a", "13")


@on_the_code
class Topics(Rule):
    """Only topics.hpp has names of topics and services."""

    check = house.check_topics

    def test_a_literal_in_a_call_is_found(self):
        for call in (
            'pub_ = nh.advertise<auv_msgs::TaskState>("task_state", 1);',
            'sub_ = nh.subscribe("odom", 1, &Node::OnOdom, this);',
            'pub_ = nh.advertise<std_msgs::Header>(\n    "done", 1);',
            'srv_ = nh.advertiseService("reset", &Node::OnReset, this);',
            'client_ = nh.serviceClient<auv_msgs::Reset>("reset");',
        ):
            self.assert_found({"auv_dynamics/src/nodes/world_node.cpp": call}, "world_node.cpp:1")
        for call in (
            "sub_ = nh.subscribe(topics::kOdom, 1, &Node::OnOdom, this);",
            'sub_ = nh.subscribe(topics::kOdom, 1, "text");',
            '// nh.subscribe("odom", 1)',
        ):
            self.assert_clean({"auv_dynamics/src/nodes/world_node.cpp": call})

    def test_a_second_place_for_a_name_is_found(self):
        header = 'inline constexpr char kClock[] = "/clock";\n'
        node = "stg_monitor/src/nodes/marker_node.cpp"
        self.assert_clean({TOPICS: header})
        self.assert_found({TOPICS: header, node: 'const char* kTime = "/clock";\n'}, f"src/{node}:1")
        self.assert_clean({TOPICS: header, "stg_bringup/test/a_test.cpp": 'Wait("/clock");\n'})


@on_the_code
class Namespaces(Rule):
    """Each package has its own namespace."""

    check = house.check_namespaces

    def test_each_part_has_its_own(self):
        self.assert_clean(
            {
                "auv_common/src/a.cpp": "namespace stg {\nnamespace inner {\n}\n}\n",
                "auv_common/src/config/a.cpp": "namespace stg::config {\n",
                "auv_dynamics/src/a.cpp": "namespace fs = std::filesystem;\nnamespace stg::dynamics {",
                "auv_dynamics/src/nodes/a.cpp": "namespace stg::nodes {\n",
                "stg_env/src/scenario/scenario.cpp": "namespace stg {\n",
                "marl_trainer/src/learn/nn/a.cpp": "namespace stg::learn::nn {\n",
            }
        )

    def test_a_forward_declaration_of_another_is_no_code(self):
        path = "stg_env/include/stg_env/env/env.hpp"
        self.assert_clean({path: "namespace stg::agent {\nclass Agent;\nstruct Packet;\n}\n"})
        self.assert_found({path: "namespace stg::agent {\nclass Agent;\nint f();\n}\n"}, "agent")

    def test_that_of_another_is_found(self):
        for path, name in (
            ("auv_dynamics/src/a.cpp", "stg"),
            ("auv_dynamics/src/a.cpp", "stg::acoustics"),
            ("acoustic_channel/include/acoustic_channel/a.hpp", "stg::dynamics"),
            ("stg_agent/src/nodes/a.cpp", "stg::agent"),
            ("stg_env/src/env/a.cpp", "stg"),
            ("marl_trainer/src/learn/a.cpp", "stg::learning"),
        ):
            self.assert_found({path: f"\nnamespace {name} {{\n"}, f"src/{path}:2: namespace {name}:")


@on_the_code
class Registries(Rule):
    """The registry that lists a name decides what it means."""

    check = house.check_registries

    def test_names_are_found_in_their_registry(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "auv_dynamics/src/targets/motions.cpp")
            file.parent.mkdir(parents=True)
            file.write_text(REGISTRY)
            self.assertEqual(set(house.registered(pathlib.Path(folder))), {"straight", "evasive"})

    def test_the_code_has_registries(self):
        self.assertGreater(len(house.registered()), 5)

    def test_a_comparison_elsewhere_is_found(self):
        files = {"auv_dynamics/src/targets/motions.cpp": REGISTRY + 'bool a = name == "evasive";\n'}
        self.assert_clean(files)
        for text in ('if (c.motion == "evasive") {\n', 'return "straight" != c.motion;\n'):
            path = "stg_env/src/env/env.cpp"
            self.assert_found({**files, path: text}, f"src/{path}:1", "motions.cpp")
        self.assert_clean({**files, "auv_dynamics/test/a_test.cpp": 'EXPECT_TRUE(n == "evasive");'})
        self.assert_clean({**files, "stg_env/src/env/env.cpp": 'if (c.motion == "other") {\n'})


@on_the_code
class Scenarios(Rule):
    """Only composition roots take a whole scenario."""

    check = house.check_scenarios

    def test_a_parameter_is_found_however_it_is_passed(self):
        for text in (
            "void Fly(const Scenario& s);\n",
            "void Fly(int n, stg::Scenario scenario = {});\n",
            "void Fly(\n    const std::vector<Scenario>& mix, int n) {\n",
            "auto f = [](const Scenario&) {};\n",
            "void Fly(const dynamics::WorldScenario& s, int n);\n",
        ):
            self.assert_found({"stg_env/src/record/a.cpp": text}, "src/stg_env/src/record/a.cpp:1")
            self.assert_clean({"stg_env/src/env/vector_env.cpp": text})
            self.assert_clean({"stg_env/test/env/a_test.cpp": text})

    def test_a_section_a_result_and_a_local_are_none(self):
        for text in (
            "void Fly(const WorldConfig& world, const RunConfig& run);\n",
            "const Scenario& s = env.scenario(e);\n",
            "Scenario Load(const std::string& file);\n",
            "return config::Load<Scenario>(file, scope);\n",
        ):
            self.assert_clean({"stg_env/src/record/a.cpp": text})

    def test_the_page_names_every_root(self):
        page = (ROOT / "docs" / "architecture.md").read_text()
        for root in house.COMPOSITION_ROOTS:
            self.assertIn(f"`{root}`", page)


@on_the_code
class Ranks(Rule):
    """A single process is the only rank of one. No code asks whether it is alone."""

    check = house.check_ranks

    def test_the_question_is_found(self):
        path = "marl_trainer/src/learn/a.cpp"
        for text in ("if (team.ranks->size() == 1) {\n", "x = ranks.size() > 1 ? a : b;\n"):
            self.assert_found({path: text}, f"src/{path}:1")
        for text in ("Communicator* ranks = Alone();\n", "const int n = ranks.size();\n"):
            self.assert_clean({path: text})


class Picture(unittest.TestCase):
    """The picture of the house shows the packages, folders and arrows that the code has."""

    def check(self, *arguments):
        """Compares the picture with the code; returns the exit status."""
        program = ROOT / "scripts" / "lint" / "draw_architecture.py"
        done = subprocess.run(
            ["/usr/bin/python3", str(program), "--check", *map(str, arguments)],
            stdout=subprocess.DEVNULL,
            check=False,
        )
        return done.returncode

    def test_it_is_that_of_the_code(self):
        self.assertEqual(self.check(), 0, "run scripts/lint/draw_architecture.py")

    def test_it_is_not_that_of_another_code(self):
        with tempfile.TemporaryDirectory() as folder:
            for package in ("lower", "upper"):
                file = pathlib.Path(folder, package, "src", "a", "b.cpp")
                file.parent.mkdir(parents=True)
                file.write_text('#include "lower/a/b.hpp"\n')
                pathlib.Path(folder, package, "package.xml").write_text("<package/>")
            self.assertEqual(self.check("--source", folder), 1)


class Words(unittest.TestCase):
    """Comments and texts call a program "it"."""

    def found(self, name, text):
        """Returns the lines with findings in a file with this name."""
        with tempfile.TemporaryDirectory() as folder:
            pathlib.Path(folder, name).write_text(text, encoding="utf-8")
            _, findings = words.check_words(pathlib.Path(folder), [pathlib.Path(name)])
        return [int(finding.split(":")[1]) for finding in findings]

    def test_the_repository_keeps_it(self):
        self.assertEqual(words.check_words()[1], [])

    def test_comments_and_texts_are_read_but_names_are_not(self):
        self.assertEqual(self.found("a.cpp", "int told = 0;  // x\n// Nobody listens.\n"), [2])
        self.assertEqual(self.found("a.hpp", '#include "who.hpp"\nFail("nobody asked");\n'), [2])
        self.assertEqual(self.found("a.py", 'def told():\n    """Told of it."""\n'), [2])
        self.assertEqual(self.found("a.md", "`told`\n```\nwho\n```\nThe node who waits.\n"), [5])
        self.assertEqual(self.found("a.msg", "uint8 x  # whoever sent it\n"), [1])

    def test_people_are_who(self):
        text = "People who train, and the user who reads. The packet who waits.\n"
        self.assertEqual(self.found("a.md", text), [1])
        self.assertEqual(self.found("a.md", text.split(". ")[0]), [])


if __name__ == "__main__":
    unittest.main()
