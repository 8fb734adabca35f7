"""Checks the shipped rviz files: they can be read, and show only topics that are published."""

import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree

import rospkg
import yaml

PACKAGE = pathlib.Path(rospkg.RosPack().get_path("stg_bringup"))
SOURCES = PACKAGE.parent
MARKERS = SOURCES / "stg_monitor" / "src" / "nodes" / "markers"
FRAMES = {"world", "world_ned", r"auv_\d+/base_link", r"auv_\d+/altimeter", r"target_\d+"}
PLUGINS = "/usr/share/rviz/plugin_description.xml"


def rviz_files():
    """Returns {file name: content} of the shipped views."""
    return {path.name: yaml.safe_load(path.read_text()) for path in (PACKAGE / "rviz").glob("*.rviz")}


def displays(node):
    """Yields every display of a view, also those in groups."""
    for display in node.get("Displays") or []:
        yield display
        yield from displays(display)


def published_markers():
    """Returns the marker topics. `markers` is the name of the node in view.launch, and its private topics are
    the ones that its header names."""
    (node,) = [
        node
        for node in ElementTree.parse(PACKAGE / "launch" / "view.launch").getroot().iter("node")
        if node.get("type") == "marker_node"
    ]
    header = (MARKERS / "topics.hpp").read_text()
    names = re.findall(r'constexpr char k\w+\[\] = "(\w+)"', header)
    return {f"/{node.get('name')}/{name}" for name in names}


def search_maps():
    """Returns the topic of AUV 0's search map, as the header of the agent names it."""
    header = (SOURCES / "stg_agent" / "src" / "nodes" / "include" / "stg_agent" / "nodes" / "topics.hpp").read_text()
    (name,) = re.findall(r'constexpr char kSearchMap\[\] = "(\w+)"', header)
    return {f"/auv_0/{name}"}


def marker_namespaces():
    """Returns the namespaces of the markers."""
    source = "".join(path.read_text() for path in sorted(MARKERS.rglob("*.cpp")))
    return set(re.findall(r'\b(?:Sphere|Lines|New|Text|Mesh|Circle|Trail|Clashes)\("(\w+)"', source))


def published_frames():
    """Returns patterns for the frames that the world publishes, from the headers that name them."""
    patterns = set()
    for header in SOURCES.rglob("topics.hpp"):
        frames = header.read_text().partition("namespace stg::frames {")[2]
        patterns |= set(re.findall(r'constexpr char k\w+\[\] = "(\w+)"', frames))
        for text in re.findall(r"return (.+std::to_string.+);", frames):
            parts = [part.strip('"') for part in text.split(" + ")]
            patterns.add("".join(r"\d+" if "to_string" in part else part for part in parts))
    return patterns


def view_for(view, scenario):
    """Returns the content of a view as view.py opens it for a scenario."""
    with tempfile.TemporaryDirectory() as folder:
        asked, made = pathlib.Path(folder) / "s.yaml", pathlib.Path(folder) / "v.rviz"
        asked.write_text(yaml.safe_dump(scenario))
        subprocess.run(
            ["/usr/bin/python3", SOURCES / "stg_monitor" / "scripts" / "view.py", view, "--scenario-file",
             asked, "--write", made], check=True,
        )  # fmt: skip
        return yaml.safe_load(made.read_text())


class RvizFiles(unittest.TestCase):
    """The views open without errors."""

    def test_there_is_an_overview_and_a_close_up(self):
        self.assertEqual(set(rviz_files()), {"overview.rviz", "follow.rviz"})

    def test_every_display_and_view_is_a_class_that_rviz_has(self):
        known = {
            entry.get("name") for entry in ElementTree.parse(PLUGINS).getroot().iter("class")
        }
        self.assertIn("rviz/MarkerArray", known)
        for name, view in rviz_files().items():
            manager = view["Visualization Manager"]
            classes = [d["Class"] for d in displays(manager)]
            classes.append(manager["Views"]["Current"]["Class"])
            for shown in classes:
                self.assertIn(shown, known, name)

    def test_every_topic_shown_is_published(self):
        markers = published_markers()
        self.assertEqual(len(markers), 3)
        published = markers | search_maps()
        shown = set()
        for view in rviz_files().values():
            for display in displays(view["Visualization Manager"]):
                topics = [v for k, v in display.items() if k.endswith("Topic") and v]
                for topic in topics:
                    self.assertIn(topic, published)
                shown.update(topics)
        self.assertEqual(shown, published)

    def test_every_namespace_shown_is_published(self):
        known = marker_namespaces()
        for name, view in rviz_files().items():
            for display in displays(view["Visualization Manager"]):
                for namespace in display.get("Namespaces") or {}:
                    self.assertIn(namespace, known, name)

    def test_every_frame_is_published(self):
        known = published_frames()
        self.assertEqual(known, FRAMES)
        for name, view in rviz_files().items():
            manager = view["Visualization Manager"]
            frames = [manager["Global Options"]["Fixed Frame"]]
            frames.append(manager["Views"]["Current"]["Target Frame"])
            for frame in frames:
                matches = [p for p in known if re.fullmatch(p, frame)]
                self.assertTrue(matches or frame == "<Fixed Frame>", f"{name}: {frame}")

    def test_launch_names_the_files_that_exist(self):
        for view in ("overview", "follow"):
            self.assertTrue((PACKAGE / "rviz" / f"{view}.rviz").is_file())
        text = (PACKAGE / "launch" / "view.launch").read_text()
        self.assertIn('type="view.py" args="$(arg view) ', text)

    def test_the_camera_fits_the_scenario(self):
        def camera(view, scenario):
            return view_for(view, scenario)["Visualization Manager"]["Views"]["Current"]

        def shown_m(view, scenario):
            """Half the height of what the camera sees at its focal point."""
            current = camera(view, scenario)
            return current["Distance"] * math.tan(0.5 * current["Field of View"])

        field = {"workspace": {"half_extent_m": 2000.0}, "vehicle": {"radius_m": 2.5},
                 "reward": {"band_m": [60.0, 120.0]}, "sea": {"open": True},
                 "reset": {"deploy": "area"}}  # fmt: skip
        box = {"workspace": {"half_extent_m": 1.0}, "vehicle": {"radius_m": 0.011},
               "reward": {"band_m": [0.010, 0.015]}}  # fmt: skip
        for scenario in (box, field):
            extent = scenario["workspace"]["half_extent_m"]
            self.assertLess(extent, shown_m("overview", scenario))
            self.assertLess(shown_m("overview", scenario), 2.0 * extent)
        # If AUVs start around one target, the overview shows them and not the whole sea.
        near = dict(field, reset={"deploy": "around", "stage": "medium",
                                  "stages": {"medium": {"auv_distance_m": [200.0, 500.0]}}})  # fmt: skip
        self.assertEqual(camera("overview", near)["Target Frame"], "target_0")
        self.assertLess(620.0, shown_m("overview", near))
        self.assertLess(shown_m("overview", near), 2.0 * 620.0)
        two = dict(near, target={"count": 2})
        self.assertEqual(shown_m("overview", two), shown_m("overview", field))
        band = field["reward"]["band_m"][1]
        self.assertLess(1.3 * band, shown_m("follow", field))
        self.assertLess(shown_m("follow", field), 3.0 * band)
        shipped = rviz_files()["follow.rviz"]["Visualization Manager"]["Views"]["Current"]
        self.assertEqual(camera("follow", box)["Distance"], shipped["Distance"])
        self.assertEqual(camera("follow", {})["Distance"], shipped["Distance"])

    def test_the_search_map_is_shown_where_there_is_one(self):
        def maps(view, scenario):
            shown = displays(view_for(view, scenario)["Visualization Manager"])
            return [(d["Enabled"], d["Value"]) for d in shown if d["Class"] == "rviz/Map"]

        for view in ("overview", "follow"):
            self.assertEqual(maps(view, {"track": {"search_cell_m": 150.0}}), [(True, True)])
            for without in ({}, {"track": {"search_cell_m": 0.0}}):
                self.assertEqual(maps(view, without), [(False, False)])

    def test_white_captions_can_be_read_over_every_depth(self):
        source = (MARKERS / "parts" / "terrain_markers.cpp").read_text().partition("kStops[] = {")[2]
        stops = re.findall(r"{([\d., ]+)}", source.partition("}};")[0] + "}")
        self.assertEqual(len(stops), 5)
        white, before = 1.0 + 0.05, 0.0
        for stop in stops:
            linear = [(c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4)
                      for c in map(float, stop.split(",")[1:])]  # fmt: skip
            luminance = sum(w * c for w, c in zip((0.2126, 0.7152, 0.0722), linear))
            self.assertGreater(white / (luminance + 0.05), 3.0, stop)  # the limit of WCAG for large letters
            self.assertGreater(luminance, before, "shallower is lighter")
            before = luminance

    def test_a_scenario_that_is_none_is_refused_in_one_line(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            texts = ("[1]", "sea: 3", "reward: {band_m: [1]}", "sea: {}\nsea: {}", "a: [", "a: 2026-99-99",
                     "[" * 5000, None)  # fmt: skip
            for text in texts:
                file = folder / "scenario.yaml"
                if text is None:
                    file.unlink()
                    os.mkfifo(file)
                else:
                    file.write_text(text)
                run = subprocess.run(
                    ["/usr/bin/python3", SOURCES / "stg_monitor" / "scripts" / "view.py", "follow", "--scenario-file",
                     file, "--write", folder / "view"], stderr=subprocess.PIPE, check=False,
                    universal_newlines=True, timeout=60,
                )  # fmt: skip
                self.assertEqual(run.returncode, 2, text)
                self.assertRegex(run.stderr, r"^view: [^\n]*scenario.yaml:[^\n]*\n$")


    def test_options_that_are_unknown_are_refused_and_names_of_ros_pass(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "s.yaml").write_text("{}")
            for words, status in ((["--bogus"], 2), (["more"], 2), (["__name:=rviz", "_x:=1", "a:=b"], 0)):
                run = subprocess.run(
                    ["/usr/bin/python3", SOURCES / "stg_monitor" / "scripts" / "view.py", "follow", "--scenario-file",
                     folder / "s.yaml", "--write", folder / "view", *words], stderr=subprocess.PIPE, check=False,
                    universal_newlines=True, timeout=60,
                )  # fmt: skip
                self.assertEqual(run.returncode, status, run.stderr)
                if status:
                    self.assertIn(f"unknown option '{words[0]}'", run.stderr)


class Replay(unittest.TestCase):
    """replay.launch finds a bag by any form of its name."""

    def arguments_of_player(self, bag, folder):
        """Returns the player's command line as roslaunch resolves it in `folder`."""
        done = subprocess.run(
            ["roslaunch", "--args", "player", str(PACKAGE / "launch" / "replay.launch")]
            + [f"bag:={bag}"],
            cwd=folder,
            env={**os.environ, "PWD": folder},
            stdout=subprocess.PIPE,
            universal_newlines=True,
            check=True,
        )
        return done.stdout.split()

    def test_a_relative_bag_is_taken_from_the_users_folder(self):
        self.assertIn("/usr/share/run.bag", self.arguments_of_player("run.bag", "/usr/share"))

    def test_an_absolute_bag_stays_and_the_bag_drives_the_clock(self):
        words = self.arguments_of_player("/data/run.bag", "/usr/share")
        self.assertIn("/data/run.bag", words)
        self.assertIn("--clock", words)


if __name__ == "__main__":
    unittest.main()
