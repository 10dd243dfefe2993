#!/usr/bin/env python3
"""Renders small scenes with Raystream and with Mitsuba 3, and sets them side by side.

    pip install mitsuba==3.9.1 numpy
    python3 tools/compare-with-mitsuba.py target/release/raystream [--samples N] [CASE ...]

Each renderer makes --renders independent pictures of --samples samples a pixel. Printed are, for
each case, by how much the means of the pictures differ, and the largest difference of any block of
8x6 pixels in any colour component, in standard errors of that difference. Of some hundred such
numbers the largest is about 3 where both have one expectation.

The cases "as described" have Raystream's materials in both: mitsuba_materials.py is written from
what the documentation says of them.
"""

import argparse
import glob
import json
import math
import os
import re
import subprocess
import sys
import tempfile

import numpy as np

WIDTH, HEIGHT = 48, 36
BLOCK = (8, 6)
DEPTH = 8
EYE, TARGET, FOV = [0, 1.6, 4.2], [0, 0.7, 0], 38
COPPER = {"eta": [0.2, 0.92, 1.1], "k": [3.91, 2.45, 2.14]}


def write_ball(path, rows=48, columns=96):
    """A ball of radius 0.8 that stands on the floor, with normals and texture coordinates."""
    lines = []
    for row in range(rows + 1):
        for column in range(columns + 1):
            polar, azimuth = math.pi * row / rows, 2 * math.pi * column / columns
            ring = math.sin(polar)
            n = (ring * math.cos(azimuth), math.cos(polar), -ring * math.sin(azimuth))
            lines.append("v %.9g %.9g %.9g" % (0.8 * n[0], 0.8 * n[1] + 0.8, 0.8 * n[2]))
            lines.append("vt %.9g %.9g" % (column / columns, 1 - row / rows))
            lines.append("vn %.9g %.9g %.9g" % n)
    corner = lambda row, column: "%d/%d/%d" % ((row * (columns + 1) + column + 1,) * 3)
    for row in range(rows):
        for column in range(columns):
            a, b = corner(row, column), corner(row, column + 1)
            c, d = corner(row + 1, column), corner(row + 1, column + 1)
            if row > 0:
                lines.append(f"f {a} {d} {b}")
            if row < rows - 1:
                lines.append(f"f {a} {c} {d}")
    open(path, "w").write("\n".join(lines) + "\n")


def write_quad(path, corners):
    lines = ["v %g %g %g" % tuple(corner) for corner in corners]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "f 1/1 2/2 3/3", "f 1/1 3/3 4/4"]
    open(path, "w").write("\n".join(lines) + "\n")


FLOOR = [(-4, 0, 4), (4, 0, 4), (4, 0, -4), (-4, 0, -4)]
LAMP = [(-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1)]


class Case:
    """A scene for both: the ball's material, what lights it, and changes of the camera."""

    def __init__(self, ball, ball_mi, light=None, light_mi=None, camera=None, camera_mi=None):
        self.ball, self.ball_mi = ball, ball_mi
        self.light, self.light_mi = light or {}, light_mi or {}
        self.camera, self.camera_mi = camera or {}, camera_mi or {}
        self.depth = DEPTH
        self.lamp = None
        # A material for Mitsuba that takes the place of Raystream's picture.
        self.instead = None
        self.floor, self.floor_mi = GREY, GREY_MI

    def lights(self):
        """What lights it, for both."""
        return self.light, self.light_mi


def rgb(*values):
    values = values * 3 if len(values) == 1 else values
    return {"type": "rgb", "value": list(map(float, values))}


GREY = {"type": "diffuse", "reflectance": [0.5, 0.5, 0.5]}
GREY_MI = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(0.5)}}
SKY = {"background": [1.0, 1.0, 1.0]}
SKY_MI = {"sky": {"type": "constant", "radiance": rgb(1)}}


def cases(mi, folder):
    """All cases by their names."""
    found = {}
    for roughness in (0.2, 0.5, 0.8):
        alpha = roughness**2
        found[f"rough conductor {roughness}"] = Case(
            {"type": "conductor", **COPPER, "roughness": roughness},
            {"type": "twosided", "bsdf": {
                "type": "roughconductor", "distribution": "ggx", "alpha": alpha,
                "eta": rgb(*COPPER["eta"]), "k": rgb(*COPPER["k"])}},
            SKY, SKY_MI)
        found[f"rough dielectric {roughness}"] = Case(
            {"type": "principled", "reflectance": [1, 1, 1], "transmission": 1, "ior": 1.5,
             "roughness": roughness},
            {"type": "roughdielectric", "distribution": "ggx", "alpha": alpha, "int_ior": 1.5,
             "ext_ior": 1.0},
            SKY, SKY_MI)
    found["smooth dielectric"] = Case(
        {"type": "dielectric", "ior": 1.5},
        {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}, SKY, SKY_MI)
    # Where little light is lost to several reflections.
    gold = [1.0, 0.77, 0.34]
    found["principled: metallic 0.2"] = Case(
        {"type": "principled", "reflectance": gold, "metallic": 1, "roughness": 0.2},
        {"type": "principled", "base_color": rgb(*gold), "metallic": 1.0, "roughness": 0.2},
        SKY, SKY_MI)
    found["principled: transmission 0.2"] = Case(
        {"type": "principled", "reflectance": [1, 1, 1], "transmission": 1, "ior": 1.5,
         "roughness": 0.2},
        {"type": "principled", "base_color": rgb(1), "spec_trans": 1.0, "eta": 1.5,
         "roughness": 0.2}, SKY, SKY_MI)
    found["anisotropic conductor 0.2"] = Case(
        {"type": "conductor", **COPPER, "roughness": 0.2, "anisotropy": 0.3},
        brushed_copper(), *sun_and_sky(mi, folder, is_plain=True).lights())
    position = [1.5, 3.0, 2.0]
    found["point"] = Case(
        GREY, GREY_MI,
        {"lights": [{"type": "point", "position": position, "intensity": [9, 8, 7]}]},
        {"lamp": {"type": "point", "position": position, "intensity": rgb(9, 8, 7)}})
    aim = [-1.5, -2.4, -2.0]
    found["spot"] = Case(
        GREY, GREY_MI,
        {"lights": [{"type": "spot", "position": position, "direction": aim,
                     "intensity": [20, 18, 16], "inner_angle": 34.99, "outer_angle": 35}]},
        {"lamp": {"type": "spot", "intensity": rgb(20, 18, 16), "cutoff_angle": 35,
                  "beam_width": 34.99,
                  "to_world": mi.ScalarTransform4f().look_at(
                      origin=position, target=[p + d for p, d in zip(position, aim)],
                      up=[0, 1, 0])}})
    found["directional"] = Case(
        GREY, GREY_MI,
        {"lights": [{"type": "directional", "direction": aim, "irradiance": [3, 2.5, 2]}]},
        {"lamp": {"type": "directional", "direction": aim, "irradiance": rgb(3, 2.5, 2)}})
    found["thin lens"] = Case(
        GREY, GREY_MI, SKY, SKY_MI,
        {"aperture": 0.15, "focus": 2.5},
        {"type": "thinlens", "aperture_radius": 0.15, "focus_distance": 2.5})
    found["sun and sky"] = sun_and_sky(mi, folder)
    found["textured lamp"] = textured_lamp(mi, folder)
    found["normal map"] = normal_map(mi, folder)
    return found | anisotropy(mi, folder) | described(mi, folder)


# Balls whose material is written for Mitsuba as well, by its keys in scene files.
DESCRIBED = {
    "metal": {"reflectance": [1.0, 0.77, 0.34], "metallic": 1.0},
    "paint": {"reflectance": [0.6, 0.3, 0.1]},
    "paint, coloured specular": {
        "reflectance": [0.6, 0.3, 0.1], "specular": [2.0, 1.5, 1.0], "ior": 1.4},
    "transmission": {"reflectance": [0.9, 0.95, 1.0], "transmission": 1.0, "ior": 1.5},
    "coated paint": {"reflectance": [0.6, 0.3, 0.1], "coat": 1.0, "coat_roughness": 0.2},
    "sheen": {"reflectance": [0.1, 0.05, 0.2], "sheen": [0.8, 0.7, 0.9], "sheen_roughness": 0.4},
    "anisotropic metal": {
        "reflectance": [1.0, 0.77, 0.34], "metallic": 1.0, "anisotropy": 0.7},
    "all at once": {
        "reflectance": [0.9, 0.6, 0.3], "metallic": 0.3, "transmission": 0.5, "ior": 1.5,
        "coat": 0.6, "coat_roughness": 0.3, "sheen": [0.3, 0.4, 0.5], "sheen_roughness": 0.5},
}


def anisotropy(mi, folder):
    """Mitsuba's own anisotropic metal against what is written here, one difference after another."""
    from mitsuba_materials import described as written

    lights = sun_and_sky(mi, folder, is_plain=True).lights()
    keys = {**COPPER, "roughness": 0.2, "anisotropy": 0.3}
    steps = {
        "one facet, masked independently": {"independent masking": True, "one facet": True},
        "one facet": {"one facet": True},
        "several facets": {}}
    found = {}
    for name, differences in steps.items():
        case = Case(keys, brushed_copper(), *lights)
        case.instead = written({**keys, **differences})
        found[f"anisotropic conductor 0.2, {name}"] = case
    found["as described: anisotropic conductor 0.2"] = Case(
        {"type": "conductor", **keys}, written(keys), *lights)
    return found


def brushed_copper():
    """Mitsuba's metal of roughness 0.2 and anisotropy 0.3."""
    return {"type": "twosided", "bsdf": {
        "type": "roughconductor", "distribution": "ggx", "alpha_u": 0.04 + 0.96 * 0.3**2,
        "alpha_v": 0.04, "eta": rgb(*COPPER["eta"]), "k": rgb(*COPPER["k"])}}


def described(mi, folder):
    """Materials against what their documentation says, under the sun and the sky."""
    from mitsuba_materials import described as written

    lights = sun_and_sky(mi, folder, is_plain=True).lights()
    found = {}
    for roughness in (0.2, 0.5, 0.8):
        copper = {**COPPER, "roughness": roughness}
        found[f"as described: conductor {roughness}"] = Case(
            {"type": "conductor", **copper}, written(copper), *lights)
        for name, keys in DESCRIBED.items():
            keys = {**keys, "roughness": roughness}
            found[f"as described: {name} {roughness}"] = Case(
                {"type": "principled", **keys}, written(keys), *lights)
    return found


def sky(polar, azimuth, is_plain):
    """Radiances by the angle to +y and the one about it, from -z towards +x."""
    sine, zero = np.sin(polar)[:, None], 0 * azimuth[None]
    x, y, z = sine * np.sin(azimuth)[None], np.cos(polar)[:, None] + zero, -sine * np.cos(azimuth)
    sun = np.array([0.5, 0.6, 0.62])
    sun /= np.linalg.norm(sun)
    cosine = x * sun[0] + y * sun[1] + z * sun[2]
    picture = (0.3 + 0.5 * (1 - np.abs(y)))[..., None] * np.array([0.6, 0.8, 1.0])
    if is_plain:
        # Which RGB9E5 has without rounding: blocks of it have no noise.
        picture = np.full_like(picture, 0.5)
    picture += 150 * np.exp((cosine - 1) / 0.0015)[..., None] * np.array([1.0, 0.9, 0.7])
    return picture.astype(np.float32)


def sun_and_sky(mi, folder, is_plain=False):
    """An environment, brighter at the horizon unless plain, with a sun of some degrees."""
    width, height = 1024, 512
    azimuth = ((np.arange(width) + 0.5) / width - 0.5) * 2 * math.pi
    name = "plain-sky.exr" if is_plain else "sky.exr"
    ours, theirs = os.path.join(folder, name), os.path.join(folder, "mi-" + name)
    mi.Bitmap(sky((np.arange(height) + 0.5) / height * math.pi, azimuth, is_plain)).write(ours)
    # Theirs has -z at its left edge, and its first and last row at the poles.
    rows = np.arange(height) / (height - 1) * math.pi
    mi.Bitmap(np.roll(sky(rows, azimuth, is_plain), -width // 2, axis=1)).write(theirs)
    return Case(GREY, GREY_MI, {"environment": {"file": name}},
                {"sky": {"type": "envmap", "filename": theirs}})


def textured_lamp(mi, folder):
    """A lamp that is a picture; light that has met the floor once, since lamps reflect otherwise."""
    rng = np.random.default_rng(5)
    picture = rng.integers(0, 256, (8, 8, 3)).astype(np.uint8)
    file = os.path.join(folder, "lamp.png")
    mi.Bitmap(picture).write(file)
    case = Case(GREY, GREY_MI)
    case.depth = 2
    case.lamp = (
        {"type": "principled", "reflectance": [0, 0, 0], "radiance": [6, 6, 6],
         "textures": {"emission": {"file": "lamp.png"}}},
        {"type": "area", "radiance": {
            "type": "bitmap", "filename": file, "filter_type": "bilinear", "wrap_mode": "repeat"}},
        6.0)
    return case


def normal_map(mi, folder):
    """A floor of white metal with waves in its map of normals, under the sun and the sky."""
    size = 32
    place = (np.arange(size) + 0.5) / size * 2 * math.pi
    normal = np.ones((size, size, 3))
    normal[..., 0] = 0.1 * np.sin(2 * place)[None] + 0.05 * np.cos(3 * place)[:, None]
    normal[..., 1] = 0.1 * np.cos(place)[None] * np.sin(2 * place)[:, None]
    normal /= np.linalg.norm(normal, axis=2, keepdims=True)
    file = os.path.join(folder, "normal.png")
    mi.Bitmap(np.round((normal * 0.5 + 0.5) * 65535).astype(np.uint16)).write(file)
    case = sun_and_sky(mi, folder)
    roughness = 0.05
    case.floor = {"type": "principled", "reflectance": [1, 1, 1], "metallic": 1,
                  "roughness": roughness, "textures": {"normal": {"file": "normal.png"}}}
    # Theirs darkens where the light grazes the triangle unless it is told not to.
    case.floor_mi = {"type": "twosided", "bsdf": {
        "type": "normalmap", "use_shadowing_function": False,
        "normalmap": {"type": "bitmap", "raw": True, "filename": file},
        "bsdf": {"type": "roughconductor", "distribution": "ggx", "alpha": roughness**2,
                 "material": "none"}}}
    return case


def ours(case, folder, raystream, samples, seed):
    meshes = [{"file": "floor.obj", "material": case.floor},
              {"file": "ball.obj", "material": case.ball, "normals": "smooth"}]
    if case.lamp:
        meshes.append({"file": "lamp.obj", "material": case.lamp[0]})
    scene = {
        "format": 2, "name": "case", "film": {"width": WIDTH, "height": HEIGHT},
        "camera": {"origin": EYE, "target": TARGET, "up": [0, 1, 0], "fov_y": FOV, **case.camera},
        "meshes": meshes, "integrator": {"max_depth": case.depth, "rr_depth": 5}, **case.light}
    file, picture = os.path.join(folder, "case.json"), os.path.join(folder, "ours.exr")
    json.dump(scene, open(file, "w"))
    done = subprocess.run([
        raystream, "render", file, "--device", "cpu", "--spp", str(samples), "--allocator",
        "uniform", "--sampler", "independent", "--seed", str(seed), "--quiet", "-o", picture],
        capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return picture


def read(mi, file):
    """The colours of a picture with layers."""
    for name, layer in mi.Bitmap(file).split():
        if name in ("<root>", "color"):
            return np.array(layer.convert(mi.Bitmap.PixelFormat.RGB), dtype=np.float64)
    sys.exit(f"{file}: no layer of colours")


def theirs(mi, case, folder, ball):
    look = mi.ScalarTransform4f().look_at(origin=EYE, target=TARGET, up=[0, 1, 0])
    obj = lambda name, bsdf, **more: {
        "type": "obj", "filename": os.path.join(folder, name), "bsdf": bsdf, **more}
    scene = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": case.depth, "rr_depth": 5},
        "sensor": {
            "type": "perspective", "fov": FOV, "fov_axis": "y", "near_clip": 1e-4,
            "to_world": look, **case.camera_mi,
            "film": {"type": "hdrfilm", "width": WIDTH, "height": HEIGHT, "pixel_format": "rgb",
                     "component_format": "float32", "rfilter": {"type": "box"}},
            "sampler": {"type": "independent", "sample_count": 1}},
        "floor": obj("floor.obj", case.floor_mi),
        "ball": obj("ball.obj", ball), **case.light_mi}
    if case.lamp:
        black = {"type": "diffuse", "reflectance": rgb(0)}
        scene["lamp"] = obj("lamp.obj", black, emitter=case.lamp[1])
    return mi.load_dict(scene), case.lamp[2] if case.lamp else 1.0


def blocks(picture):
    width, height = BLOCK
    return picture.reshape(HEIGHT // height, height, WIDTH // width, width, 3).mean(axis=(1, 3))


def compare(mi, name, case, arguments, folder):
    count = arguments.renders

    def by_mitsuba(ball, first_seed):
        scene, scale = theirs(mi, case, folder, ball)
        render = lambda seed: np.array(mi.render(scene, spp=arguments.samples, seed=seed), np.float64)
        return [blocks(scale * render(seed)) for seed in range(first_seed, first_seed + count)]

    if case.instead:
        a = by_mitsuba(case.instead, 1001)
    else:
        a = [blocks(read(mi, ours(case, folder, arguments.raystream, arguments.samples, seed)))
             for seed in range(1, count + 1)]
    b = by_mitsuba(case.ball_mi, 1)
    a, b = np.stack(a), np.stack(b)
    error = np.sqrt((a.var(axis=0, ddof=1) + b.var(axis=0, ddof=1)) / count)
    off = np.abs(a.mean(axis=0) - b.mean(axis=0)) / np.maximum(error, 1e-12)
    whole_a, whole_b = a.mean(axis=(1, 2, 3)), b.mean(axis=(1, 2, 3))
    ratio = whole_a.mean() / whole_b.mean() - 1
    spread = math.sqrt((whole_a.var(ddof=1) + whole_b.var(ddof=1)) / count) / whole_b.mean()
    worst = np.unravel_index(off.argmax(), off.shape)
    relative = a.mean(axis=0)[worst] / max(b.mean(axis=0)[worst], 1e-12) - 1
    print(f"| {name} | {100 * ratio:+.3f} % | {100 * spread:.3f} % | {off.max():.1f} "
          f"| {100 * relative:+.2f} % |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("raystream")
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--renders", type=int, default=16)
    parser.add_argument("--variant", default="llvm_ad_rgb")
    parser.add_argument("cases", nargs="*")
    arguments = parser.parse_intermixed_args()
    if arguments.variant.startswith("llvm") and "DRJIT_LIBLLVM_PATH" not in os.environ:
        # The oldest ones that are found first do not know all instructions.
        number = lambda path: int((re.search(r"(\d+)", os.path.basename(path)) or [0, 0])[1])
        known = glob.glob("/usr/lib/*-linux-gnu/libLLVM*.so*")
        if known:
            os.environ["DRJIT_LIBLLVM_PATH"] = max(known, key=number)
    import mitsuba as mi

    mi.set_variant(arguments.variant)
    with tempfile.TemporaryDirectory() as folder:
        write_ball(os.path.join(folder, "ball.obj"))
        write_quad(os.path.join(folder, "floor.obj"), FLOOR)
        write_quad(os.path.join(folder, "lamp.obj"), LAMP)
        print("| case | mean | its standard error | worst block, in standard errors | its difference |")
        print("|---|---|---|---|---|")
        for name, case in cases(mi, folder).items():
            if not arguments.cases or any(wanted in name for wanted in arguments.cases):
                compare(mi, name, case, arguments, folder)


if __name__ == "__main__":
    main()
