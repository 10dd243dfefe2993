#!/usr/bin/env python3
"""Renders scenes on the CPU with Raystream and with Mitsuba 3, by turns, and compares the speed.

    pip install mitsuba==3.9.1 numpy        (its LLVM mode needs LLVM 17 or later: libllvm19)
    python3 tools/race-on-the-cpu.py target/release/raystream SCENE.json ... [--rounds N]

Scenes are of format 1: one OBJ, a pinhole, matt (with a texture), mirror, glass and lamps. Both
trace paths of at most --depth segments, uniformly. What is compared is the time of processors (user
time), which other programs disturb less than the wall's. Loading is left out: of Raystream by the
difference of two renders, of Mitsuba by its clock after a first pass. Each round measures all of
them once; printed are the medians in nanoseconds a path, and Mitsuba's over each.
"""

import argparse
import glob
import json
import os
import re
import statistics
import subprocess
import sys
import time

import numpy as np


def numbers(words):
    return [float(word) for word in words]


def materials(path):
    """What an MTL says of each material: its lines by their first word."""
    found, current = {}, {}
    for line in open(path, errors="replace"):
        words = line.split()
        if not words:
            continue
        if words[0] == "newmtl":
            current = found.setdefault(words[1], {})
        current[words[0]] = words[1:]
    return found


def bsdf(lines, override, folder):
    """Mitsuba's BSDF, and the radiance of a lamp."""
    rgb = lambda values: {"type": "rgb", "value": list(values)}
    zero = [0.0, 0.0, 0.0]
    kind = override.get("type")
    illum = int(lines.get("illum", ["1"])[0])
    emission = override.get("radiance", numbers(lines.get("Ke", [])[:3]) or zero)
    if kind == "mirror" or kind is None and illum in (3, 5):
        reflectance = override.get("reflectance", numbers(lines.get("Ks", zero)))
        mirror = {"type": "conductor", "material": "none", "specular_reflectance": rgb(reflectance)}
        return {"type": "twosided", "bsdf": mirror}, zero
    if kind == "dielectric" or kind is None and illum in (4, 6, 7, 9):
        ior = override.get("ior") or float(lines.get("Ni", ["1.5"])[0])
        return {"type": "dielectric", "int_ior": float(ior), "ext_ior": 1.0}, zero
    reflectance = rgb(override.get("reflectance", numbers(lines.get("Kd", zero))))
    texture = lines.get("map_Kd") if "reflectance" not in override else None
    if texture and max(emission) == 0:
        name = re.split(r"[\\/]", texture[-1])[-1].lower()
        there = glob.glob(f"{folder}/**/*", recursive=True)
        files = {os.path.basename(file).lower(): file for file in there}
        if name in files:
            reflectance = {"type": "bitmap", "filename": files[name]}
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}, emission


def corners(path):
    """The corners of an OBJ's triangles by material, as indices of positions, coordinates, normals;
    and these."""
    lists = {"v": [], "vt": [], "vn": []}
    faces, current = {}, None
    for line in open(path, errors="replace"):
        words = line.split()
        if not words:
            continue
        if words[0] in lists:
            lists[words[0]].append(numbers(words[1:4]))
        elif words[0] == "usemtl":
            current = faces.setdefault(words[1], [])
        elif words[0] == "f":
            polygon = []
            for word in words[1:]:
                parts = [int(part) if part else 0 for part in (word + "//").split("/")[:3]]
                sizes = [len(lists[name]) for name in ("v", "vt", "vn")]
                index = lambda p, n: p - 1 if p > 0 else n + p if p < 0 else -1
                polygon.append([index(p, n) for p, n in zip(parts, sizes)])
            for k in range(1, len(polygon) - 1):
                current.append([polygon[0], polygon[k], polygon[k + 1]])
    return faces, lists


def mesh(mi, name, triangles, lists, is_smooth, props):
    index = np.array(triangles, dtype=np.int64).reshape(-1, 3)
    has_uv = bool(lists["vt"] and (index[:, 1] >= 0).all())
    has_normals = bool(is_smooth and lists["vn"] and (index[:, 2] >= 0).all())
    found = mi.Mesh(name, len(index), len(index) // 3, has_vertex_normals=has_normals,
                    has_vertex_texcoords=has_uv, props=props)
    values = mi.traverse(found)
    take = lambda which, column, width: np.array(lists[which], np.float32)[index[:, column], :width]
    values["vertex_positions"] = take("v", 0, 3).ravel()
    values["faces"] = np.arange(len(index), dtype=np.uint32)
    if has_uv:
        # Mitsuba's bitmaps begin at the top.
        flipped = take("vt", 1, 2) * [1, -1] + [0, 1]
        values["vertex_texcoords"] = flipped.astype(np.float32).ravel()
    if has_normals:
        values["vertex_normals"] = take("vn", 2, 3).ravel()
    values.update()
    return found


def load(mi, path, size, depth):
    scene, folder = json.load(open(path)), os.path.dirname(os.path.abspath(path))
    obj = os.path.join(folder, os.path.expandvars(scene["obj"]))
    faces, lists = corners(obj)
    known = {}
    for line in open(obj, errors="replace"):
        if line.startswith("mtllib"):
            library = line.split(maxsplit=1)[1].strip()
            known.update(materials(os.path.join(os.path.dirname(obj), library)))
    camera = scene["camera"]
    to_world = mi.ScalarTransform4f().look_at(
        origin=camera["origin"], target=camera["target"], up=camera["up"])
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}}
    made = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": depth, "rr_depth": 5},
        "sensor": {"type": "perspective", "fov": camera["fov_y"], "fov_axis": "y", "film": film,
                   "to_world": to_world, "near_clip": 1e-4, "far_clip": 1e7},
    }
    for number, (name, triangles) in enumerate(faces.items()):
        override = scene.get("materials", {}).get(name, {})
        if not triangles or override.get("type") == "null":
            continue
        surface, emission = bsdf(known.get(name, {}), override, folder)
        props = mi.Properties()
        props["bsdf"] = mi.load_dict(surface)
        if max(emission) > 0:
            radiance = {"type": "rgb", "value": list(emission)}
            props["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
        is_smooth = scene.get("normals") == "smooth"
        made[f"mesh{number}"] = mesh(mi, name, triangles, lists, is_smooth, props)
    for number, quad in enumerate(scene.get("quads", [])):
        c, u, v = (np.array(quad[key]) for key in ("corner", "u", "v"))
        points = [c, c + u, c + u + v, c, c + u + v, c + v]
        props = mi.Properties()
        props["bsdf"] = mi.load_dict({"type": "diffuse", "reflectance": 0.0})
        radiance = {"type": "rgb", "value": quad["radiance"]}
        props["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
        only = {"v": points, "vt": [], "vn": []}
        triangles = [[[k, -1, -1] for k in three] for three in ((0, 1, 2), (3, 4, 5))]
        made[f"quad{number}"] = mesh(mi, f"quad{number}", triangles, only, False, props)
    return mi.load_dict(made)


def theirs(mi, scene, size, samples):
    """Nanoseconds of processors a path."""
    np.array(mi.render(scene, spp=16, seed=1))
    start = time.process_time()
    for k in range(samples // 16):
        np.array(mi.render(scene, spp=16, seed=2 + k))
    return (time.process_time() - start) * 1e9 / (samples // 16 * 16 * size[0] * size[1])


def ours(raystream, device, scene, arguments, samples):
    """Likewise, of a render with `samples` more than another."""

    def user(spp):
        command = [raystream, "render", scene, "--device", device, "--allocator", "uniform",
                   "--quiet", "--size", arguments.size, "--spp", str(spp),
                   "--max-depth", str(arguments.depth), "--threads", str(arguments.threads),
                   "--output", os.path.join(arguments.scratch, "race.exr")]
        with open(os.devnull, "w") as nowhere:
            process = subprocess.Popen(command, stdout=nowhere, stderr=nowhere)
            _, status, usage = os.wait4(process.pid, 0)
        if status != 0:
            sys.exit(f"{' '.join(command)}: it failed")
        return usage.ru_utime

    width, height = (int(side) for side in arguments.size.split("x"))
    return (user(samples + 4) - user(4)) * 1e9 / (samples * width * height)


def main():
    formatter = argparse.RawTextHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=formatter)
    parser.add_argument("raystream")
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--devices", default="cpu,cpu:avx2,cpu:simd128,cpu:scalar")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--size", default="400x300")
    parser.add_argument("--depth", type=int, default=8)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--scratch", default="/tmp")
    arguments = parser.parse_args()
    if "DRJIT_LIBLLVM_PATH" not in os.environ:
        libraries = glob.glob("/usr/lib/*/libLLVM-*.so*")
        version = lambda path: int(re.search(r"LLVM-(\d+)", path)[1])
        newest = max(libraries, key=version, default=None)
        if newest:
            os.environ["DRJIT_LIBLLVM_PATH"] = newest
    import drjit
    import mitsuba as mi

    mi.set_variant("llvm_ad_rgb")
    drjit.set_thread_count(arguments.threads)
    size = tuple(int(side) for side in arguments.size.split("x"))
    devices = arguments.devices.split(",")
    for path in arguments.scenes:
        scene = load(mi, path, size, arguments.depth)
        found = {name: [] for name in ["mitsuba", *devices]}
        for _ in range(arguments.rounds):
            found["mitsuba"].append(theirs(mi, scene, size, 4 * arguments.samples))
            for device in devices:
                ns = ours(arguments.raystream, device, path, arguments, arguments.samples)
                found[device].append(ns)
        medians = {name: statistics.median(times) for name, times in found.items()}
        print(os.path.basename(path))
        for name, median in medians.items():
            ratio = medians["mitsuba"] / median
            spread = f"{min(found[name]):.0f} to {max(found[name]):.0f}"
            line = f"  {name:12} {median:7.0f} ns a path ({spread}), {ratio:.2f} of Mitsuba's speed"
            print(line, flush=True)


if __name__ == "__main__":
    main()
