"""Scenes of arrays are those of files."""

from __future__ import annotations

import json

import numpy as np
import pytest
import raystream as rs
from conftest import SMALL, ROOT

FLOOR = np.array([[-2, 0, 2], [2, 0, 2], [2, 0, -2], [-2, 0, -2]], dtype=np.float32)
FACES = [[0, 1, 2], [0, 2, 3]]
CAMERA = rs.Camera(origin=(0, 1, 4), target=(0, 0.5, 0), fov_y=50)
LAMP = rs.Quad(corner=[-0.5, 3, -0.5], u=[1, 0, 0], v=[0, 0, 1], radiance=[10, 10, 10])
OPTIONS = {key: value for key, value in SMALL.items() if key != "size"}


def scene(*meshes, **parts):
    parts = {"camera": CAMERA, "size": (40, 30), "lights": [LAMP], **parts}
    return rs.Scene(meshes=meshes, **parts)


def test_arrays_make_the_picture_that_files_make(tmp_path):
    obj = "".join(f"v {x} {y} {z}\n" for x, y, z in FLOOR)
    obj += "vn 0 1 0\n" + "".join(f"f {a + 1}//1 {b + 1}//1 {c + 1}//1\n" for a, b, c in FACES)
    (tmp_path / "floor.obj").write_text(obj)
    gold = {"type": "conductor", "metal": "gold", "roughness": 0.3}
    moved = {"rotate": [0, 20, 0]}
    keys = {
        "format": 2,
        "name": "scene",
        "film": {"width": 40, "height": 30},
        "camera": dict(CAMERA),
        "meshes": [
            {"file": "floor.obj", "normals": "smooth", "material": gold, "transform": moved}
        ],
        "quads": [dict(LAMP)],
    }
    (tmp_path / "scene.json").write_text(json.dumps(keys))
    of_files = rs.render(tmp_path / "scene.json", **OPTIONS)
    mesh = rs.Mesh(
        FLOOR,
        np.array(FACES, dtype=np.uint8),
        normals=np.tile([0, 1, 0], (4, 1)),
        material=rs.Conductor(metal="gold", roughness=np.float64(0.3)),
        transform=moved,
    )
    of_arrays = rs.render(scene(mesh), **OPTIONS)
    assert of_arrays.tobytes() == of_files.tobytes()
    assert of_arrays.mean() > 0


def test_quadrangles_colours_and_textures(tmp_path):
    texture = np.zeros((2, 2, 3), dtype=np.float32)
    texture[:, :, 1] = 0.5
    rs.write(tmp_path / "green.png", texture, tone_map="clip")
    uvs = [[0, 0], [1, 0], [1, 1], [0, 1]]
    green = rs.Diffuse(reflectance={"texture": str(tmp_path / "green.png")})
    # Adaptively, samples would go elsewhere for other colours.
    options = {**OPTIONS, "allocator": "uniform"}
    textured = rs.render(scene(rs.Mesh(FLOOR, [[0, 1, 2, 3]], uvs=uvs, material=green)), **options)
    coloured = rs.render(scene(rs.Mesh(FLOOR, FACES, colors=[[0, 0.5, 0]] * 4)), **options)
    for image in (textured, coloured):
        assert image[20, 20, 1] > 0 and image[20, 20, 0] == image[20, 20, 2] == 0
    # A PNG has 8 bits: next to 0.5 its steps are 0.9 %.
    np.testing.assert_allclose(textured, coloured, rtol=0.01, atol=1e-6)


def test_every_part_has_an_effect():
    mesh = rs.Mesh(FLOOR, FACES, material=rs.Diffuse(reflectance=[1, 1, 1]))
    dark = scene(mesh, lights=[rs.PointLight(position=[0, 1, 0], intensity=[1, 1, 1])])
    assert rs.render(dark, **OPTIONS).mean() > 0
    sun = [rs.DirectionalLight(direction=[0, -1, 0], irradiance=[1, 1, 1])]
    lit = rs.render(scene(mesh, lights=sun, max_depth=2), **OPTIONS, allocator="uniform")
    np.testing.assert_allclose(lit[25, 20], 1 / np.pi, rtol=1e-5)
    sky = scene(mesh, lights=[], background=np.array([0.25, 0.5, 1.0]))
    np.testing.assert_array_equal(rs.render(sky, **OPTIONS)[0, 0], [0.25, 0.5, 1])
    many = scene(rs.Mesh(FLOOR, FACES, instances=[{}, {"translate": [0, 1, 0]}]))
    assert many.triangles == 6 and many.size == (40, 30) and many.name == "scene"


def test_a_scene_without_light_is_warned_of():
    with pytest.warns(UserWarning, match="nothing emits light"):
        dark = scene(rs.Mesh(FLOOR, FACES), lights=[])
    with pytest.warns(UserWarning, match="the picture is black"):
        rs.render(dark, **OPTIONS)


def bad(values, place, value):
    values = np.array(values, dtype=float)
    values[place] = value
    return values


GOOD = {"vertices": FLOOR, "faces": FACES}
NORMALS = [[0, 1, 0]] * 4


@pytest.mark.parametrize(
    "mesh, error",
    [
        ({"vertices": FLOOR[:, :2]}, r"meshes\[1\].vertices: has the shape \(4, 2\)"),
        ({"vertices": FLOOR[0]}, r"meshes\[1\].vertices: has the shape \(3,\)"),
        ({"vertices": [["a"] * 3]}, r"meshes\[1\].vertices: is no array of numbers"),
        ({"vertices": bad(FLOOR, (2, 1), np.nan)}, r"meshes\[1\].vertices\[2\]: is not finite"),
        ({"vertices": bad(FLOOR, (3, 1), np.inf)}, r"meshes\[1\].vertices\[3\]: is not finite"),
        ({"faces": [[0, 1, 2], [0, 2, 4]]}, r"meshes\[1\].faces\[1\]: names vertex 4, but there "),
        ({"faces": [[0, 1, -1]]}, r"meshes\[1\].faces\[0\]: names vertex -1"),
        ({"faces": [[0, 1]]}, r"meshes\[1\].faces: has the shape \(1, 2\)"),
        ({"faces": [[0.0, 1.0, 2.0]]}, r"meshes\[1\].faces: has the type float64"),
        ({"faces": np.zeros((0, 3), int)}, r"meshes\[1\].faces: is empty"),
        ({"normals": NORMALS[:3]}, r"meshes\[1\].normals: has 3 rows, but there are 4 vertices"),
        ({"uvs": bad(np.zeros((4, 2)), (1, 0), np.nan)}, r"meshes\[1\].uvs\[1\]: is not finite"),
        ({"colors": bad(np.ones((4, 3)), (1, 0), 1.5)}, r"meshes\[1\].colors\[1\]: is not in"),
        ({"material": "gold"}, r"meshes\[1\].material: there is no material `gold`"),
        ({"material": rs.Diffuse(ior=2)}, r"meshes\[1\].material.*ior"),
        ({"material": {"type": "wood"}}, r"meshes\[1\].material.*`wood`.*`diffuse`"),
        ({"material": rs.Principled(roughness=2)}, r"meshes\[1\].material"),
        ({"vertices": bad(FLOOR, (1, 1), 1e30)}, r"meshes\[1\]"),
    ],
    ids=str,
)
def test_what_is_wrong_with_a_mesh_is_named(mesh, error):
    with pytest.raises(ValueError, match=error):
        scene(rs.Mesh(**GOOD), rs.Mesh(**{**GOOD, **mesh}))


@pytest.mark.parametrize(
    "parts, kind, error",
    [
        ({"camera": rs.Camera(origin=(0, 0, 0))}, ValueError, "camera.*target"),
        ({"camera": {**CAMERA, "fov": 3}}, ValueError, "camera.*fov"),
        ({"camera": {**CAMERA, "fov_y": float("nan")}}, ValueError, "not finite"),
        ({"camera": {**CAMERA, "fov_y": object()}}, TypeError, "a scene has no object"),
        ({"size": (0, 30)}, ValueError, "film.width"),
        ({"lights": [rs.Quad(corner=[0, 0, 0])]}, ValueError, r"quads\[0\].*`u`"),
        ({"lights": [rs.PointLight(intensity=[1, 1, 1])]}, ValueError, r"lights\[0\].*position"),
        ({"background": [-1, 0, 0]}, ValueError, "background"),
        ({"max_depth": 0}, ValueError, "integrator.max_depth"),
        ({"meshes": [GOOD]}, TypeError, r"meshes\[0\]: is a dict, but should be a Mesh"),
        ({"nothing": 1}, TypeError, "nothing"),
    ],
    ids=str,
)
def test_what_is_wrong_with_a_part_is_named(parts, kind, error):
    with pytest.raises(kind, match=error) as caught:
        rs.Scene(**{"camera": CAMERA, "size": (40, 30), "lights": [LAMP], **parts})
    assert "at line" not in str(caught.value)


def test_a_film_of_arrays_takes_its_scene(tmp_path):
    own = scene(rs.Mesh(FLOOR, FACES))
    whole = rs.render(own, **OPTIONS)
    renderer = rs.Renderer(own, **OPTIONS)
    next(renderer)
    renderer.save(tmp_path / "a.film")
    with pytest.raises(ValueError, match="made of arrays.*scene="):
        rs.resume(tmp_path / "a.film")
    with pytest.raises(ValueError, match="another scene"):
        rs.resume(tmp_path / "a.film", scene=scene(rs.Mesh(FLOOR + 1, FACES)))
    again = rs.resume(tmp_path / "a.film", scene=scene(rs.Mesh(FLOOR, FACES)))
    assert list(again)[-1].image.tobytes() == whole.tobytes()


def test_the_keys_are_those_of_the_schema():
    import ast
    import pathlib

    schema = json.loads((ROOT / "docs/scene.schema.json").read_text())["definitions"]
    stubs = pathlib.Path(rs.__file__).with_name("_keys.py").read_text()
    classes = {node.name: node for node in ast.parse(stubs).body if isinstance(node, ast.ClassDef)}

    def keys(name):
        return {line.target.id for line in classes[name].body if isinstance(line, ast.AnnAssign)}

    assert keys("CameraKeys") == set(schema["camera"]["properties"])
    assert keys("QuadKeys") == set(schema["quad"]["properties"])
    assert keys("LightKeys") | {"type"} == set(schema["light"]["properties"])
    assert keys("MaterialKeys") | {"type"} == set(schema["material"]["properties"])
    of_render, of_load = rs.options()
    assert keys("RenderOptions") == set(of_render)
    assert keys("LoadOptions") == set(of_load)
    kinds = {
        kind.type
        for kind in (
            rs.Diffuse, rs.Mirror, rs.Dielectric, rs.Emissive, rs.Principled, rs.Conductor
        )
    }
    assert kinds | {"null"} == set(schema["material"]["properties"]["type"]["enum"])
