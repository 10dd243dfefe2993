"""What mypy --strict must accept, and where marked, must not."""

from typing import Any

import numpy as np
import numpy.typing as npt
import raystream as rs

Image = npt.NDArray[np.float32]

scene: rs.Scene = rs.load("cornell_ball", sky=30.0)
image: Image = rs.render(scene, spp=np.int64(3), size=(8, 6), denoise=True, integrator="lvc")
image = rs.render("tea", noise=0.1, allocator="runs", time=None)
rs.render(scene, sppx=3)  # type: ignore[call-arg]
rs.render(scene, integrator="x")  # type: ignore[arg-type]
rs.load("tea", spp=3)  # type: ignore[call-arg]

for p in rs.Renderer(scene, time=3, device=["cpu", "cpu"]):
    numbers: tuple[int, float, float, int] = (p.number, p.samples, p.seconds, p.rays)
    albedo: Image = p["albedo"]
    error: float | None = p.error
    error.bit_length()  # type: ignore[union-attr]
    filtered: Image | None = p.denoised
    rs.write("a.exr", p.layers())

film: rs.Film = rs.merge(["a.film", "b.film"])
layers: dict[str, Image] = film.layers(denoise="nlm")
renderer: rs.Renderer = rs.resume("a.film", spp=3, scene=scene)
mesh = rs.Mesh(np.eye(3), [[0, 1, 2]], material=rs.Diffuse(reflectance=(1, 1, 1)))
rs.Diffuse(reflect=3)  # type: ignore[call-arg]
made = rs.Scene(
    camera=rs.Camera(origin=np.zeros(3), target=[0, 0, -1], fov_y=40),
    meshes=[mesh],
    lights=[rs.Quad(corner=(0, 0, 0), u=(1, 0, 0), v=(0, 1, 0), radiance=(1, 1, 1))],
)
devices: list[dict[str, Any]] = rs.devices()
