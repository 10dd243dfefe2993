"""The keys of scene files, and the options of renders, for type checkers."""

import os
from typing import Any, Dict, List, Literal, Sequence, Tuple, TypedDict, Union

import numpy as np
import numpy.typing as npt

Path = Union[str, "os.PathLike[str]"]
Vector = Union[Sequence[float], npt.NDArray[np.floating[Any]], npt.NDArray[np.integer[Any]]]
Texture = Dict[str, Any]
Colour = Union[Vector, Texture]
Number = Union[float, np.floating[Any], np.integer[Any]]
Whole = Union[int, np.integer[Any]]


class CameraKeys(TypedDict, total=False):
    """The keys of a camera."""

    type: Literal["perspective", "orthographic", "panorama"]
    origin: Vector
    target: Vector
    up: Vector
    fov_y: Number
    aperture: Number
    focus: Number
    blades: Whole
    width: Number


class QuadKeys(TypedDict, total=False):
    """The keys of a lamp."""

    corner: Vector
    u: Vector
    v: Vector
    radiance: Vector


class LightKeys(TypedDict, total=False):
    """The keys of a light without a surface."""

    position: Vector
    direction: Vector
    intensity: Vector
    irradiance: Vector
    inner_angle: Number
    outer_angle: Number
    angle: Number


class MaterialKeys(TypedDict, total=False):
    """The keys of a material."""

    reflectance: Colour
    radiance: Vector
    ior: Number
    transmittance: Vector
    metal: str
    eta: Vector
    k: Vector
    metallic: Number
    roughness: Number
    anisotropy: Number
    anisotropy_rotation: Number
    transmission: Number
    thin_walled: bool
    attenuation: Vector
    attenuation_distance: Number
    priority: Whole
    coat: Number
    coat_roughness: Number
    sheen: Vector
    sheen_roughness: Number
    alpha: Number
    alpha_cutoff: Number
    specular: Vector
    f90: Number
    textures: Texture


class LoadOptions(TypedDict, total=False):
    """The options of load()."""

    max_memory: Union[Number, None]
    camera: Union[str, None]
    instances: Union[Literal["auto", "always", "never"], None]
    at: Union[Number, None]
    variant: Union[str, None]
    environment: Union[Path, None]
    sky: Union[Number, None]
    environment_rotation: Union[Number, None]
    environment_strength: Union[Number, None]
    aperture: Union[Number, None]
    focus: Union[Number, None]
    panorama: Union[bool, None]

Filter = Literal[
    "auto",
    "axis-aligned",
    "bilateral",
    "features",
    "gem",
    "learned",
    "manifolds",
    "nfor",
    "nlm",
    "oidn",
]


class RenderOptions(LoadOptions, total=False):
    """The options of render() and Renderer(): those of load(), for a scene that is not loaded, and
    these."""

    spp: Union[Whole, None]
    time: Union[Number, None]
    noise: Union[Number, None]
    size: Union[Tuple[int, int], str, None]
    seed: Union[Whole, None]
    device: Union[str, List[str], None]
    naga: Union[bool, None]
    exact: Union[bool, None]
    validation: Union[bool, None]
    integrator: Union[
        Literal["auto", "megakernel", "compaction", "regeneration", "streaming", "lvc"], None
    ]
    allocator: Union[Literal["uniform", "paper", "atomic", "runs"], None]
    estimator: Union[
        Literal[
            "auto",
            "axis-aligned",
            "bilateral",
            "features",
            "gem",
            "halves",
            "learned",
            "manifolds",
            "nfor",
            "nlm",
            "variance",
        ],
        None,
    ]
    denoise: Union[Filter, bool, None]
    relative: Union[bool, None]
    initial_spp: Union[Whole, None]
    round_budget: Union[Number, None]
    halves: Union[bool, None]
    filter_radius: Union[Whole, None]
    filter_position: Union[Number, None]
    filter_normal: Union[Number, None]
    filter_albedo: Union[Number, None]
    filter_features_only: Union[bool, None]
    no_smoothing: Union[bool, None]
    sampler: Union[Literal["sobol", "independent"], None]
    max_depth: Union[Whole, None]
    rr_depth: Union[Whole, None]
    light_paths: Union[Whole, None]
    connections: Union[Whole, None]
    no_light_tracing: Union[bool, None]
    pixel_filter: Union[Literal["box", "tent", "gaussian", "blackman-harris"], None]
    pixel_filter_width: Union[Number, None]
    ray_offset: Union[Number, None]
    bvh: Union[Literal["fast", "high"], None]
    part: Union[Tuple[int, int], str, None]
