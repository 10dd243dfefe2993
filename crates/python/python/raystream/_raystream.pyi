from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple, Union, final

import numpy as np
import numpy.typing as npt
from typing_extensions import Unpack

from ._keys import Filter, LoadOptions, Number, Path, RenderOptions, Vector, Whole
from ._parts import Mesh

__all__ = [
    "Film",
    "Renderer",
    "Round",
    "Scene",
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

_Array = npt.NDArray[np.float32]

__version__: str

@final
class Scene:
    """A scene: loaded by load(), or made of arrays.

    All but `meshes`, `size` and `lights` are what they are in scene files (docs/SCENE_FORMAT.md):
    dictionaries with those keys, such as Camera, PointLight and the materials make; `lights` may be
    Quads, too. Raises ValueError, which names the part that is wrong.
    """

    def __new__(
        cls,
        *,
        camera: Dict[str, Any],
        size: Tuple[int, int] = (800, 600),
        meshes: Sequence[Mesh] = (),
        materials: Optional[Dict[str, Dict[str, Any]]] = None,
        lights: Sequence[Dict[str, Any]] = (),
        environment: Optional[Dict[str, Any]] = None,
        background: Optional[Vector] = None,
        max_depth: Optional[int] = None,
        rr_depth: Optional[int] = None,
        name: str = "scene",
    ) -> Scene: ...
    @property
    def name(self) -> str:
        """What the scene is called."""
    @property
    def size(self) -> Tuple[int, int]:
        """Width and height of its picture in pixels."""
    @property
    def triangles(self) -> int:
        """How many triangles it has."""
    @property
    def warnings(self) -> List[str]:
        """What the picture will not show, a sentence each."""
    @property
    def details(self) -> List[str]:
        """Each thing that the picture will not show: what `warnings` sum up."""
    @property
    def cameras(self) -> List[str]:
        """The names of its cameras; load(camera=...) takes one."""
    @property
    def variants(self) -> List[str]:
        """The names of the variants of its materials; load(variant=...) takes one."""

@final
class Renderer:
    """A render under way: an iterator of its rounds.

    Arguments as of render(). Each round is a Round, whose layers and error can be looked at until
    the next one begins; those of the last one, always. The time of the option `time` runs in rounds
    only. Ctrl-C ends a round with KeyboardInterrupt, as soon as nothing is lost, and the render may
    be saved, or go on.
    """

    def __new__(
        cls, scene: Union[Scene, Path], **options: Unpack[RenderOptions]
    ) -> Renderer: ...
    def __iter__(self) -> Iterator[Round]: ...
    def __next__(self) -> Round: ...
    def save(self, path: Path) -> None:
        """Writes the render to a film file, with which resume() and `raystream resume` go on.

        Between rounds that is all of it: a render that goes on makes the picture, bit for bit, that
        it would have made without a break.
        """
    @property
    def size(self) -> Tuple[int, int]:
        """Width and height of the picture in pixels."""
    @property
    def device(self) -> str:
        """The device that has the film."""
    @property
    def stop(self) -> Optional[str]:
        """What has ended the render: "samples", "time" or "noise"; None before that."""

@final
class Round:
    """A round of a render, with the picture as it is after it.

    `round["albedo"]` is a layer, a float32 array of shape (height, width) or (height, width, 3);
    `names` are those that there are, as in an EXR (docs/LAYERS.md). They can be looked at until the
    next round begins: after that, RuntimeError. Whoever never looks pays nothing.
    """

    @property
    def number(self) -> int:
        """Which round of its Renderer it is, from 1."""
    @property
    def samples(self) -> float:
        """Samples per pixel so far, on average; those of earlier runs included."""
    @property
    def seconds(self) -> float:
        """Seconds that the rounds of this Renderer have taken."""
    @property
    def rays(self) -> int:
        """Rays traced so far."""
    @property
    def error(self) -> Optional[float]:
        """The picture's estimated relative error (0.02 is 2 %): with `denoise`, of the filtered
        one. None where errors are not estimated."""
    @property
    def image(self) -> _Array:
        """The picture: the layer "color"."""
    @property
    def denoised(self) -> Optional[_Array]:
        """The filtered picture: the layer "denoised", or None without the option `denoise`."""
    @property
    def names(self) -> List[str]:
        """The names of the layers."""
    def layers(self) -> Dict[str, _Array]:
        """All layers by their names, as write() takes them."""
    def __getitem__(self, name: str, /) -> _Array: ...
    def __contains__(self, name: str, /) -> bool: ...

@final
class Film:
    """A render in a film file: what Renderer.save() and `raystream render --checkpoint` write.

    `film["color"]` is a layer, as of a Round, but for those of estimated errors, which are not in
    it.
    """

    def __new__(cls, path: Path) -> Film: ...
    def save(self, path: Path) -> None:
        """Writes it to a film file."""
    @property
    def scene(self) -> str:
        """What its scene is called."""
    @property
    def size(self) -> Tuple[int, int]:
        """Width and height of the picture in pixels."""
    @property
    def samples(self) -> float:
        """Samples per pixel, on average over the pixels."""
    @property
    def seconds(self) -> float:
        """Seconds that it took."""
    @property
    def parts(self) -> List[str]:
        """The parts of the render that it has, such as ["0/4"]; none where it is of a whole one."""
    @property
    def image(self) -> _Array:
        """The picture: the layer "color"."""
    @property
    def names(self) -> List[str]:
        """The names of the layers."""
    def layers(self, *, denoise: Optional[Filter] = None, device: str = "cpu") -> Dict[str, _Array]:
        """All layers by their names; with `denoise`, the name of a filter, that of the filtered
        picture, too, which takes samples in halves."""
    def __getitem__(self, name: str, /) -> _Array: ...
    def __contains__(self, name: str, /) -> bool: ...

def load(scene: Path, **options: Unpack[LoadOptions]) -> Scene:
    """Loads a scene: a scene file, a glTF (.gltf, .glb), an OBJ, a PLY, or one that ships, by name.

    The options are those of `raystream render`, by the same names with `_` for `-`. What the
    picture will not show is warned of. Raises FileNotFoundError, another OSError or ValueError,
    which name the file and the place in it.
    """

def render(scene: Union[Scene, Path], **options: Unpack[RenderOptions]) -> _Array:
    """Renders a scene to an array of float32, (height, width, 3): linear Rec.709.

    By default 64 samples per pixel are spent, adaptively, on the best GPU or else on the CPU. With
    `denoise` the picture is the filtered one. The interpreter's lock is released; Ctrl-C ends the
    render with KeyboardInterrupt. Raises ValueError, OSError, MemoryError and, where a device
    fails, RuntimeError.
    """

def resume(
    film: Path,
    *,
    scene: Optional[Scene] = None,
    spp: Optional[Whole] = None,
    time: Optional[Number] = None,
    noise: Optional[Number] = None,
    device: Union[str, List[str], None] = None,
) -> Renderer:
    """Goes on with a render that was kept in a film file, here or by the command line.

    `spp` counts the samples that the film has, `time` begins anew; without spp, time and noise the
    render ends where it was to end. A scene that was made of arrays is not in the film: give the
    same one. Raises ValueError if the scene or its files have changed.
    """

def merge(films: Sequence[Path]) -> Film:
    """Adds up the films of parts of one render, in any order; warns where some are missing.

    films: paths of film files of renders with the option `part`. Raises ValueError if they do not
    go together.
    """

def read(path: Path) -> Dict[str, _Array]:
    """Reads a picture: an .exr, all of its layers, or a .png, as linear Rec.709.

    The channels R, G, B are "color", layer.R ... are "layer". Numbers of an EXR are as they are in
    the file.
    """

def write(
    path: Path,
    layers: Union[npt.ArrayLike, Dict[str, Any]],
    *,
    exposure: float = 0.0,
    tone_map: str = "soft",
) -> None:
    """Writes a picture: an array of shape (height, width, 3), or a dictionary of layers.

    An .exr has all layers, a .png shows "denoised" if that is there, else "color", with exposure in
    stops and the tone map soft, clip or aces. Files appear whole or not at all.
    """

def devices() -> List[Dict[str, Any]]:
    """The devices that can render, and why others cannot."""

def scenes() -> Dict[str, str]:
    """The scenes that ship: what there is to see, by their names."""

def options() -> Tuple[Dict[str, str], Dict[str, str]]:
    """The options of render() and Renderer(), and those of load(): names and what they mean."""
