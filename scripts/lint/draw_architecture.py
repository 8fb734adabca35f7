#!/usr/bin/python3
"""Draws docs/images/architecture.svg from the includes of the code.

A box is a package, in the layer above all that it includes; in it are its folders with the number
of their sources and headers, each right of those that it includes. An arrow says how many lines
`#include` go from one package to another, tests and benchmarks left out. With --check nothing is
drawn: the exit status is 1 when the picture shows other packages, folders or arrows than the code
has (numbers may differ).
"""

import argparse
import collections
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

from stg_common.program import run_program
from tree import cpp_files, included, includes, logical

PICTURE = ROOT / "docs" / "images" / "architecture"
MESSAGES = "auv_msgs"
COLOURS = ("#4d6680", "#1b7f79", "#2a6fb0", "#b3641c", "#7a4fa3", "#b03a5b", "#6b7a1f")


class House:
    """The structure of the code: packages, their folders, and their includes."""

    def __init__(self, source):
        self.folders = collections.defaultdict(collections.Counter)  # package: {folder: files}
        self.arrows = collections.Counter()  # (package, package): includes
        self._within = collections.defaultdict(set)  # (package, folder): folders that it includes
        names = {path.parent.name for path in source.glob("*/package.xml")}
        for file in cpp_files(source):
            package, folder = self._place(logical(file))
            if folder and not self._is_test(folder):
                self.folders[package][folder] += 1
        for kind in ("msg", "srv"):
            for file in source.glob(f"{MESSAGES}/{kind}/*.{kind}"):
                self.folders[MESSAGES][file.suffix[1:]] += 1
        for include in includes(source):
            ours, folder = self._place(logical(include.file))
            theirs, other = self._place(included(include, source))
            if self._is_test(folder) or theirs not in names:
                continue
            if ours != theirs:
                self.arrows[ours, theirs] += 1
            elif other and folder != other:
                self._within[ours, folder].add(other)

    @staticmethod
    def _is_test(folder):
        return folder.split("/")[0] in ("test", "bench")

    @staticmethod
    def _place(path):
        """Returns (package, folder) of a path in the form of an #include. All nodes are one folder."""
        package, folders = path.parts[0], path.parts[1:-1]
        return package, "nodes" if folders[:1] == ("nodes",) else "/".join(folders)

    def layers(self):
        """Returns the packages of each layer, the lowest first."""
        depth = {}

        def visit(package):
            if package not in depth:
                below = [b for a, b in sorted(self.arrows) if a == package and b != MESSAGES]
                depth[package] = 1 + max((visit(b) for b in below), default=-1)
            return depth[package]

        for package in sorted(set(self.folders) - {MESSAGES}):
            visit(package)
        layers = [[] for _ in range(max(depth.values()) + 1)]
        for package in sorted(depth):
            layers[depth[package]].append(package)
        if MESSAGES in self.folders:
            layers[0].append(MESSAGES)
        return layers

    def ordered_folders(self, package):
        """Returns the folders of a package, each after those that it includes."""
        order = []

        def visit(folder, above):
            if folder in order or folder in above:
                return
            for other in sorted(self._within[package, folder]):
                visit(other, above | {folder})
            if folder in self.folders[package]:
                order.append(folder)

        for folder in sorted(self.folders[package], key=lambda f: (f == "nodes", f)):
            visit(folder, set())
        return order

    def shape(self):
        """Returns the content of the picture without numbers, for a comparison."""
        return {
            "folders": {p: sorted(f) for p, f in sorted(self.folders.items())},
            "arrows": sorted(f"{a} -> {b}" for a, b in self.arrows),
        }


def tint(colour, share):
    """Returns `colour` mixed with white; `share` of the colour is left."""
    parts = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
    return "#" + "".join(f"{round(255 - (255 - part) * share):02x}" for part in parts)


class Picture:
    """Places and draws a House. Lengths are points, y grows upwards."""

    WIDTH, CHIP, LINE, PAD, GAP, BETWEEN = 640, 17, 22, 9, 32, 24
    LANE, NEAREST = 17, 22  # distances between lines that pass packages on their left, and from the packages
    MESSAGES_WIDTH = 150

    def __init__(self, house):
        # pylint: disable=import-outside-toplevel
        import matplotlib

        matplotlib.use("Agg")
        matplotlib.rcParams.update({"svg.hashsalt": "architecture", "font.family": "DejaVu Sans"})
        import matplotlib.pyplot
        from matplotlib import font_manager, patches, textpath

        self.plt, self.patches, self.textpath = matplotlib.pyplot, patches, textpath.TextPath
        self.font = font_manager.FontProperties
        self.house = house
        self.layers = house.layers()
        self.layer_of = {p: i for i, layer in enumerate(self.layers) for p in layer}
        lowest_first = [p for layer in self.layers for p in layer]
        coloured = [p for p in lowest_first if p != MESSAGES]
        self.colour = {p: COLOURS[i % len(COLOURS)] for i, p in enumerate(coloured)}
        self.colour[MESSAGES] = "#5f5f5f"
        # Arrows past a layer go down in a lane of their package. The lane of the highest package is the
        # outermost.
        self.far = {
            p: [q for a, q in sorted(house.arrows) if a == p and self._is_far(p, q)]
            for p in lowest_first
        }
        lanes = [p for p in lowest_first if self.far[p]]
        self.left = 10 + self.NEAREST + self.LANE * (len(lanes) - 1)
        self.lane = {p: self.left - self.NEAREST - self.LANE * i for i, p in enumerate(lanes)}
        self.box, self.crossing = {}, {}
        self.chips = {}

    def _is_far(self, package, other):
        return other != MESSAGES and self.layer_of[package] - self.layer_of[other] > 1

    def width_of(self, text, size, weight="normal"):
        """Returns the width of a text in points."""
        return self.textpath((0, 0), text, size=size, prop=self.font(weight=weight)).get_extents().x1

    def labels(self, package):
        """Returns [(folder, its label)] in drawing order."""
        count = self.house.folders[package]
        labels = []
        for folder in self.house.ordered_folders(package):
            messages = self.house.arrows[package, MESSAGES] if folder == "nodes" else 0
            arrow = f"  \N{RIGHTWARDS ARROW} {MESSAGES} {messages}" if messages else ""
            labels.append((folder, f"{folder} {count[folder]}{arrow}"))
        return labels

    def fill(self, package, width):
        """Returns the rows of a box: lists of (folder, label, x from its left edge, width)."""
        rows, x = [[]], self.PAD
        for folder, label in self.labels(package):
            wide = self.width_of(label, 8.5) + 12
            if rows[-1] and x + wide > width - self.PAD:
                rows.append([])
                x = self.PAD
            rows[-1].append((folder, label, x, wide))
            x += wide + 6
        return rows

    def place(self):
        """Finds the position of every box, from the bottom up. Returns the total height."""
        y = 44
        for layer in self.layers:
            free = self.WIDTH - 10 - self.left - self.BETWEEN * (len(layer) - 1)
            width = {p: free / len(layer) for p in layer}
            if MESSAGES in layer:
                width = {p: (free - self.MESSAGES_WIDTH) / (len(layer) - 1) for p in layer}
                width[MESSAGES] = self.MESSAGES_WIDTH
            self.chips.update({p: self.fill(p, width[p]) for p in layer})
            height = 27 + self.LINE * max(len(self.chips[p]) for p in layer)
            # Arrows from distant packages end at the left side of the first box in a layer.
            arrivals = sum(layer[0] in far for far in self.far.values())
            height = max(height, 12 + 14 * arrivals)
            x = self.left
            for package in layer:
                self.box[package] = (x, y, width[package], height)
                x += width[package] + self.BETWEEN
            beside = set(layer[1:])  # at these boxes, arrows from distant packages end at the top
            self.crossing[layer[0]] = sum(len(beside & set(far)) for far in self.far.values())
            y += height + self.GAP + 9 * self.crossing[layer[0]]
        return y - self.GAP + 10

    def arrow(self, points, colour, count):
        """Draws a line through the points with an arrow head, and its number near the head."""
        xs, ys = zip(*points)
        self.axes.plot(xs[:-1], ys[:-1], color=colour, lw=1.3, solid_capstyle="butt", zorder=1)
        style = self.patches.ArrowStyle("-|>", head_length=4.5, head_width=2.4)
        self.axes.add_patch(
            self.patches.FancyArrowPatch(
                points[-2], points[-1], arrowstyle=style, color=colour, lw=1.3, shrinkA=0,
                shrinkB=0, mutation_scale=1.25, zorder=3,
            )
        )
        (x0, y0), (x1, y1) = points[-2:]
        down = x0 == x1
        self.axes.text(
            x1 + (5 if down else -9), y1 + (11 if down else 1.5), str(count), color=colour, fontsize=8,
            ha="left" if down else "right", va="center" if down else "bottom", zorder=4,
        )

    def draw_box(self, package):
        """Draws a package and its folders."""
        x, y, width, height = self.box[package]
        colour = self.colour[package]
        outline = "round,pad=0,rounding_size=5"
        box = self.patches.FancyBboxPatch(
            (x, y), width, height, boxstyle=outline, fc=tint(colour, 0.10), ec=colour, lw=1.4, zorder=2
        )
        self.axes.add_patch(box)
        self.axes.text(
            x + self.PAD, y + height - 13, package, fontsize=11, weight="bold", color=colour,
            va="center", zorder=4,
        )
        for row, chips in enumerate(self.chips[package]):
            bottom = y + height - 24 - self.LINE * (row + 1) + (self.LINE - self.CHIP)
            for folder, label, dx, wide in chips:
                ros = folder == "nodes" or package == MESSAGES
                chip = self.patches.FancyBboxPatch(
                    (x + dx, bottom), wide, self.CHIP, boxstyle="round,pad=0,rounding_size=4",
                    fc=tint(colour, 0.85) if ros else "white", ec=tint(colour, 0.6), lw=0.8, zorder=3,
                )
                self.axes.add_patch(chip)
                self.axes.text(
                    x + dx + wide / 2, bottom + self.CHIP / 2, label, fontsize=8.5, ha="center",
                    va="center_baseline", color="white" if ros else "#222222", zorder=4,
                )

    def draw_near(self):
        """Draws the arrows to the next layer, straight down."""
        for (package, other), count in sorted(self.house.arrows.items()):
            if other == MESSAGES or self._is_far(package, other):
                continue
            x0, y0, width0, _ = self.box[package]
            x1, y1, width1, height1 = self.box[other]
            middle = (max(x0, x1) + min(x0 + width0, x1 + width1)) / 2
            self.arrow([(middle, y0), (middle, y1 + height1)], self.colour[package], count)

    def draw_far(self):
        """Draws the arrows past a layer: out to the left, down, and in from the left; or in from above, if
        another package of the layer is in the way."""
        into, above = collections.Counter(), collections.Counter()
        for package, others in self.far.items():
            lane, (x0, y0, _, height0) = self.lane.get(package), self.box[package]
            for other in others:
                x1, y1, _, height1 = self.box[other]
                start = [(x0, y0 + height0 / 2), (lane, y0 + height0 / 2)]
                if x1 == self.left:
                    y = y1 + height1 - 13 - 14 * into[other]
                    into[other] += 1
                    path = [(lane, y), (x1, y)]
                else:
                    layer = self.layer_of[other]
                    y = y1 + height1 + self.GAP - 6 + 9 * above[layer]
                    x = x1 + 30 + 34 * above[layer]
                    above[layer] += 1
                    path = [(lane, y), (x, y), (x, y1 + height1)]
                count = self.house.arrows[package, other]
                self.arrow(start + path, self.colour[package], count)

    def draw(self, stem):
        """Writes stem.svg."""
        height = self.place()
        figure = self.plt.figure(figsize=(self.WIDTH / 72, height / 72))
        self.axes = figure.add_axes([0, 0, 1, 1])
        self.axes.set(xlim=(0, self.WIDTH), ylim=(0, height))
        self.axes.axis("off")
        for package in self.box:
            self.draw_box(package)
        self.draw_far()
        self.draw_near()
        self.axes.text(
            self.left, 25,
            "Folders with their number of files, each right of those that it includes; arrows with their number\n"
            "of #include lines. Dark: what has ROS in it; nodes alone include the messages of auv_msgs.",
            fontsize=8.5, color="#444444", va="center", linespacing=1.5,
        )
        shape = json.dumps(self.house.shape(), sort_keys=True)
        figure.savefig(f"{stem}.svg", metadata={"Date": None, "Description": shape})


def drawn_shape(svg):
    """Returns the shape that draw() stored in the picture."""
    # pylint: disable=import-outside-toplevel
    import xml.etree.ElementTree as ElementTree

    (text,) = [e.text for e in ElementTree.parse(svg).iter() if e.tag.endswith("}description")]
    return json.loads(text)


def main(argv):
    """Draws or checks the picture; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="only compare with the picture")
    parser.add_argument("--source", type=pathlib.Path, default=ROOT / "src", help="packages")
    parser.add_argument("--out", type=pathlib.Path, default=PICTURE, help="without suffix")
    options = parser.parse_args(argv)
    house = House(options.source)
    if not house.folders:
        parser.error(f"--source: there are no packages in {options.source}")
    if not options.check:
        Picture(house).draw(options.out)
        return 0
    if drawn_shape(f"{options.out}.svg") == house.shape():
        return 0
    print(f"{options.out}.svg shows something else than the code: run scripts/lint/draw_architecture.py")
    return 1


if __name__ == "__main__":
    run_program("draw_architecture", lambda: main(sys.argv[1:]))
