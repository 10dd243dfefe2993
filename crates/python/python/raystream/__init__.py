"""Raystream: an adaptive path tracer, on the GPU and on the CPU.

    import raystream as rs

    scene = rs.load("cornell_ball")               # or a .json, .gltf, .glb, .ply
    image = rs.render(scene, spp=64)              # float32, (height, width, 3), linear Rec.709
    rs.write("picture.png", image)

    for p in rs.Renderer(scene, time=10, allocator="runs"):
        print(p.samples, p.error, p["albedo"].shape)

Options are those of `raystream render` (docs/GUIDE.md), by the same names with `_` for `-`;
options() lists them. docs/PYTHON.md says more.
"""

import os as _os

if not any(name in _os.environ for name in ("DISPLAY", "WAYLAND_DISPLAY", "XDG_RUNTIME_DIR")):
    # Without a desktop, a layer of Mesa that picks the desktop's GPU complains on stderr.
    _os.environ.setdefault("NODEVICE_SELECT", "1")

from ._parts import (
    Camera,
    Conductor,
    Dielectric,
    Diffuse,
    DirectionalLight,
    Emissive,
    Mesh,
    Mirror,
    PointLight,
    Principled,
    Quad,
    SpotLight,
)
from ._raystream import (
    Film,
    Renderer,
    Round,
    Scene,
    __version__,
    devices,
    load,
    merge,
    options,
    read,
    render,
    resume,
    scenes,
    write,
)

__all__ = [
    "Camera",
    "Conductor",
    "Dielectric",
    "Diffuse",
    "DirectionalLight",
    "Emissive",
    "Film",
    "Mesh",
    "Mirror",
    "PointLight",
    "Principled",
    "Quad",
    "Renderer",
    "Round",
    "Scene",
    "SpotLight",
    "__version__",
    "devices",
    "load",
    "merge",
    "options",
    "read",
    "render",
    "resume",
    "scenes",
    "write",
]
