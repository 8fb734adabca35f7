#!/usr/bin/python3
"""Writes the vehicle's meshes for rviz: binary STL, length 1, bow along +x.

`auv_hull.stl` has the colour of the task phase; `auv_fittings.stl` (fins, propeller, mast) stays dark. Scaled
by twice the collision radius, the whole vehicle is inside its collision sphere.
"""

import argparse
import math
import pathlib
import struct

RADIUS = 0.105
SEGMENTS = 28


def profile():
    """Returns the hull's outline from stern to bow as [(x, radius)]."""
    points = [(-0.46, 0.018)]
    for k in range(1, 7):
        s = k / 6.0
        points.append((-0.46 + 0.22 * s, 0.018 + (RADIUS - 0.018) * math.sin(0.5 * math.pi * s)))
    points.append((0.34, RADIUS))
    for k in range(1, 8):
        angle = 0.5 * math.pi * k / 7.0
        points.append((0.34 + 0.15 * math.sin(angle), max(RADIUS * math.cos(angle), 0.0)))
    return points


def lathe(outline):
    """Returns the triangles of `outline` turned about the x axis."""
    rings = [
        [
            (x, r * math.cos(2 * math.pi * k / SEGMENTS), r * math.sin(2 * math.pi * k / SEGMENTS))
            for k in range(SEGMENTS)
        ]
        for x, r in outline
    ]
    triangles = []
    for a, b in zip(rings, rings[1:]):
        for k in range(SEGMENTS):
            n = (k + 1) % SEGMENTS
            triangles += [(a[k], b[n], b[k]), (a[k], a[n], b[n])]
    stern = (outline[0][0], 0.0, 0.0)
    triangles += [(stern, rings[0][(k + 1) % SEGMENTS], rings[0][k]) for k in range(SEGMENTS)]
    return triangles


def plate(corners, thickness, roll):
    """Returns a flat plate of `corners` (x, height) in the x-z plane, rolled about x by `roll`."""
    half = 0.5 * thickness

    def place(x, y, z):
        return (
            x,
            y * math.cos(roll) - z * math.sin(roll),
            y * math.sin(roll) + z * math.cos(roll),
        )

    left = [place(x, half, z) for x, z in corners]
    right = [place(x, -half, z) for x, z in corners]
    triangles = []
    for k in range(1, len(corners) - 1):
        triangles += [(left[0], left[k], left[k + 1]), (right[0], right[k + 1], right[k])]
    for k in range(len(corners)):
        n = (k + 1) % len(corners)
        triangles += [(left[k], right[k], right[n]), (left[k], right[n], left[n])]
    return triangles


def fittings():
    """Returns four tail fins, a three-bladed propeller on its hub, and a mast."""
    triangles = []
    fin = [(-0.42, 0.03), (-0.28, 0.07), (-0.33, 0.19), (-0.42, 0.19)]
    for k in range(4):
        triangles += plate(fin, 0.018, 0.5 * math.pi * k)
    blade = [(-0.485, 0.0), (-0.465, 0.0), (-0.475, 0.06), (-0.49, 0.06)]
    for k in range(3):
        triangles += plate(blade, 0.05, math.pi / 6 + 2 * math.pi * k / 3)
    triangles += lathe([(-0.498, 0.006), (-0.49, 0.02), (-0.46, 0.02)])
    triangles += plate([(0.02, 0.09), (0.10, 0.09), (0.07, 0.17), (0.03, 0.17)], 0.02, 0.0)
    return triangles


def normal(triangle):
    """Returns the unit normal of a triangle, zero for a degenerate one."""
    a, b, c = triangle
    u = [b[k] - a[k] for k in range(3)]
    v = [c[k] - a[k] for k in range(3)]
    n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    length = math.sqrt(sum(x * x for x in n))
    return tuple(x / length for x in n) if length > 1e-12 else (0.0, 0.0, 0.0)


def stl(triangles):
    """Returns `triangles` as binary STL; degenerate ones are left out."""
    kept = [(normal(t), t) for t in triangles if normal(t) != (0.0, 0.0, 0.0)]
    body = b"".join(
        struct.pack("<12fH", *n, *t[0], *t[1], *t[2], 0) for n, t in kept
    )
    return b"AUV, length 1, bow along +x".ljust(80) + struct.pack("<I", len(kept)) + body


def meshes():
    """Returns {file name: content}."""
    return {"auv_hull.stl": stl(lathe(profile())), "auv_fittings.stl": stl(fittings())}


def main():
    """Writes the files to the given folder, or to the package's meshes/."""
    default = pathlib.Path(__file__).resolve().parents[1] / "meshes"
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, default=default,
                        help="to write them to (default: the meshes of the package)")  # fmt: skip
    folder = parser.parse_args().folder
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in meshes().items():
        (folder / name).write_bytes(content)


if __name__ == "__main__":
    main()
