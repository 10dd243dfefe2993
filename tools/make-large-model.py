#!/usr/bin/env python3
"""Makes a model of many triangles, a hilly ground, to see what a renderer does with it.

    pip install numpy
    python3 tools/make-large-model.py 10 ground.glb     # 10 million triangles: 182 MB
    python3 tools/make-large-model.py 10 ground.ply
"""

import json
import math
import struct
import sys

import numpy as np


def ground(side):
    """Positions and triangles of a square of 2 side^2 triangles, as wide as 10 units."""
    x, z = np.meshgrid(*[np.linspace(-5, 5, side + 1)] * 2)
    y = np.zeros_like(x)
    rng = np.random.default_rng(1)
    for octave in range(12):
        for turn in rng.uniform(0, 2 * math.pi, (3, 2)):
            along = x * math.cos(turn[0]) + z * math.sin(turn[0])
            y += 0.4 * 0.55**octave * np.sin(along * 1.9**octave + turn[1])
    positions = np.stack([x, y, z], axis=-1).reshape(-1, 3).astype("<f4")
    first = (np.arange(side)[:, None] * (side + 1) + np.arange(side)[None]).reshape(-1)
    below = first + side + 1
    quads = np.stack([first, below, first + 1, first + 1, below, below + 1], axis=-1)
    return positions, quads.reshape(-1, 3).astype("<u4")


def write_glb(file, positions, triangles):
    views = [positions.tobytes(), triangles.tobytes()]
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": sum(map(len, views))}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(views[0])},
            {"buffer": 0, "byteOffset": len(views[0]), "byteLength": len(views[1])}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": len(positions),
             "min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()},
            {"bufferView": 1, "componentType": 5125, "type": "SCALAR",
             "count": triangles.size}]}).encode()
    text += b" " * (-len(text) % 4)
    length = sum(map(len, views))
    file.write(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + length))
    file.write(struct.pack("<I4s", len(text), b"JSON") + text)
    file.write(struct.pack("<I4s", length, b"BIN\0"))
    file.writelines(views)


def write_ply(file, positions, triangles):
    file.write((
        "ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\n"
        "property float y\nproperty float z\nelement face %d\n"
        "property list uchar int vertex_indices\nend_header\n"
        % (len(positions), len(triangles))).encode())
    file.write(positions.tobytes())
    faces = np.empty(len(triangles), dtype=[("count", "u1"), ("corners", "<u4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    file.write(faces.tobytes())


def main():
    if len(sys.argv) != 3 or not sys.argv[2].endswith((".glb", ".ply")):
        sys.exit(__doc__)
    side = round(math.sqrt(float(sys.argv[1]) * 1e6 / 2))
    write = write_glb if sys.argv[2].endswith(".glb") else write_ply
    with open(sys.argv[2], "wb") as file:
        write(file, *ground(side))


if __name__ == "__main__":
    main()
