"""Scenes of arrays: what they are made of, as scene files and meshes in memory."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._keys import CameraKeys, LightKeys, MaterialKeys, QuadKeys

Transform = Dict[str, Any]


class Camera(Dict[str, Any]):
    """Where a scene is seen from: the keys of `camera` in scene files.

    Camera(origin=, target=, up=, fov_y=) is a pinhole, `fov_y` its vertical angle in degrees; with
    aperture= and focus= it has a lens. type="orthographic" with width=, and type="panorama" are
    others. `up` is +y if it is not given.
    """

    def __init__(self, **keys: Unpack[CameraKeys]) -> None:
        super().__init__({"up": (0, 1, 0), **keys})


class Quad(Dict[str, Any]):
    """A lamp: a parallelogram that emits on the side of cross(u, v), and reflects nothing.

    Quad(corner=, u=, v=, radiance=).
    """

    def __init__(self, **keys: Unpack[QuadKeys]) -> None:
        super().__init__(keys)


class _Typed(Dict[str, Any]):
    """A part that has a type."""

    type: str

    def __init__(self, **keys: Any) -> None:
        super().__init__({"type": self.type, **keys})


class _Light(_Typed):
    if TYPE_CHECKING:

        def __init__(self, **keys: Unpack[LightKeys]) -> None: ...


class PointLight(_Light):
    """A light at a point: PointLight(position=, intensity=)."""

    type = "point"


class SpotLight(_Light):
    """A light with a cone: SpotLight(position=, direction=, intensity=, outer_angle=)."""

    type = "spot"


class DirectionalLight(_Light):
    """Light from far away: DirectionalLight(direction=, irradiance=, angle=)."""

    type = "directional"


class _Material(_Typed):
    if TYPE_CHECKING:

        def __init__(self, **keys: Unpack[MaterialKeys]) -> None: ...


class Diffuse(_Material):
    """Paint: Diffuse(reflectance=), a colour or {"texture": file}."""

    type = "diffuse"


class Mirror(_Material):
    """A perfect mirror: Mirror(reflectance=)."""

    type = "mirror"


class Dielectric(_Material):
    """Glass, smooth or rough: Dielectric(ior=, transmittance=, roughness=, attenuation=, ...)."""

    type = "dielectric"


class Emissive(_Material):
    """A surface that shines on its front: Emissive(radiance=, reflectance=)."""

    type = "emissive"


class Principled(_Material):
    """Most surfaces: Principled(reflectance=, metallic=, roughness=, coat=, sheen=, ...)."""

    type = "principled"


class Conductor(_Material):
    """A metal: Conductor(metal="gold", roughness=), or by eta= and k=."""

    type = "conductor"


class Mesh:
    """Triangles or quadrangles of arrays.

    vertices: (n, 3), finite, in the scene's units.
    faces: (m, 3) or (m, 4), integers: rows of `vertices`. The front is where they run
        counter-clockwise.
    normals: (n, 3), of the vertices; None: the mesh is flat.
    uvs: (n, 2), of the vertices; (0, 0) is the lower left corner of a texture.
    colors: (n, 3), of the vertices, linear Rec.709 in [0, 1]; they multiply the material's.
    material: Diffuse and the like, or a dictionary as in scene files; by default grey paint, white
        under colours.
    transform, instances: where it stands, as in scene files.
    """

    def __init__(
        self,
        vertices: npt.ArrayLike,
        faces: npt.ArrayLike,
        normals: Optional[npt.ArrayLike] = None,
        uvs: Optional[npt.ArrayLike] = None,
        colors: Optional[npt.ArrayLike] = None,
        material: Union[Dict[str, Any], str, None] = None,
        transform: Optional[Transform] = None,
        instances: Optional[Sequence[Transform]] = None,
    ) -> None:
        self.vertices = vertices
        self.faces = faces
        self.normals = normals
        self.uvs = uvs
        self.colors = colors
        self.material = material
        self.transform = transform
        self.instances = instances

    def _keys(self, file: str) -> Dict[str, Any]:
        paint = {"type": "diffuse", "reflectance": [1.0 if self.colors is not None else 0.5] * 3}
        keys: Dict[str, Any] = {
            "file": file,
            "normals": "flat" if self.normals is None else "smooth",
            "material": paint if self.material is None else self.material,
        }
        if self.transform is not None:
            keys["transform"] = self.transform
        if self.instances is not None:
            keys["instances"] = list(self.instances)
        return keys

    def _ply(self, place: str) -> bytes:
        """The mesh as a binary PLY; `place` is named in errors."""
        vertices = _floats(f"{place}.vertices", self.vertices, 3)
        columns: List[Tuple[Sequence[str], npt.NDArray[np.float64]]] = [("xyz", vertices)]
        for letters, name, width in (
            (("nx", "ny", "nz"), "normals", 3),
            (("s", "t"), "uvs", 2),
            (("red", "green", "blue"), "colors", 3),
        ):
            values = getattr(self, name)
            if values is not None:
                array = _floats(f"{place}.{name}", values, width)
                if len(array) != len(vertices):
                    raise ValueError(
                        f"{place}.{name}: has {len(array)} rows, but there are {len(vertices)} "
                        "vertices; give each its own"
                    )
                columns.append((letters, array))
        if self.colors is not None:
            channels, linear = columns.pop()
            _check(f"{place}.colors", (linear < 0) | (linear > 1), "is not in [0, 1]")
            columns.append((channels, _srgb(linear)))
        faces = _faces(f"{place}.faces", self.faces, len(vertices))
        names = [letter for letters, _ in columns for letter in letters]
        header = "".join(f"property double {name}\n" for name in names)
        records = np.empty(len(faces), [("count", "u1"), ("at", "<i4", (faces.shape[1],))])
        records["count"] = faces.shape[1]
        records["at"] = faces
        table = np.concatenate([array for _, array in columns], axis=1).astype("<f8")
        text = (
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{header}"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        return text.encode() + table.tobytes() + records.tobytes()


def _check(place: str, wrong: npt.NDArray[np.bool_], what: str) -> None:
    """Fails at the first row in which something is wrong."""
    rows = np.flatnonzero(wrong.any(axis=1))
    if len(rows):
        raise ValueError(f"{place}[{rows[0]}]: {what}")


def _floats(place: str, values: npt.ArrayLike, width: int) -> npt.NDArray[np.float64]:
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{place}: is no array of numbers: {error}") from error
    if array.ndim != 2 or array.shape[1] != width:
        raise ValueError(f"{place}: has the shape {array.shape}, but should have (n, {width})")
    _check(place, ~np.isfinite(array), "is not finite")
    return array


def _srgb(linear: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Colours as a PLY has them."""
    steep = linear <= 0.0031308
    return np.where(steep, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def _faces(place: str, values: npt.ArrayLike, vertices: int) -> npt.NDArray[np.int64]:
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] not in (3, 4):
        raise ValueError(f"{place}: has the shape {array.shape}, but should have (m, 3) or (m, 4)")
    if array.dtype.kind not in "iu":
        raise ValueError(f"{place}: has the type {array.dtype}, but should have integers")
    if len(array) == 0:
        raise ValueError(f"{place}: is empty; leave the mesh out")
    if vertices >= 2**31:
        raise ValueError(f"{place}: there are more than 2^31 vertices; make several meshes")
    wrong = (array < 0) | (array >= vertices)
    rows = np.flatnonzero(wrong.any(axis=1))
    if len(rows):
        row = rows[0]
        vertex = array[row][wrong[row]][0]
        raise ValueError(f"{place}[{row}]: names vertex {vertex}, but there are {vertices}")
    return array.astype(np.int64)


def _plain(value: Any) -> Any:
    """Arrays and numbers of numpy, and paths, as JSON has them."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a scene has no {type(value).__name__}; give numbers, text, lists or arrays")


def describe(
    *,
    camera: Dict[str, Any],
    size: Tuple[int, int] = (800, 600),
    meshes: Sequence[Mesh] = (),
    materials: Optional[Dict[str, Dict[str, Any]]] = None,
    lights: Sequence[Dict[str, Any]] = (),
    environment: Optional[Dict[str, Any]] = None,
    background: Optional[npt.ArrayLike] = None,
    max_depth: Optional[int] = None,
    rr_depth: Optional[int] = None,
    name: str = "scene",
) -> Tuple[str, Dict[str, bytes]]:
    """A scene file, and the meshes that it names."""
    width, height = size
    files: Dict[str, bytes] = {}
    keys: List[Dict[str, Any]] = []
    for index, mesh in enumerate(meshes):
        if not isinstance(mesh, Mesh):
            raise TypeError(f"meshes[{index}]: is a {type(mesh).__name__}, but should be a Mesh")
        file = f"meshes[{index}]"
        files[file] = mesh._ply(file)
        keys.append(mesh._keys(file))
    scene: Dict[str, Any] = {
        "format": 2,
        "name": name,
        "film": {"width": width, "height": height},
        "camera": camera,
        "meshes": keys,
        "materials": materials or {},
        "quads": [light for light in lights if "corner" in light],
        "lights": [light for light in lights if "corner" not in light],
    }
    depths = {"max_depth": max_depth, "rr_depth": rr_depth}
    scene["integrator"] = {key: depth for key, depth in depths.items() if depth is not None}
    if environment is not None:
        scene["environment"] = environment
    if background is not None:
        scene["background"] = background
    try:
        return json.dumps(scene, allow_nan=False, default=_plain), files
    except ValueError as error:
        raise ValueError(f"the scene has a number that is not finite: {error}") from error
