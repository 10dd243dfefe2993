"""What is wrong is an error of Python, which says what there is."""

from __future__ import annotations

import numpy as np
import pytest
import raystream as rs
from conftest import SMALL


@pytest.mark.parametrize(
    "options, error",
    [
        ({"spp": 0}, "spp.*0"),
        ({"spp": -1}, "spp"),
        ({"spp": 1.5}, "spp"),
        ({"spp": True}, "spp: takes a value"),
        ({"size": (0, 3)}, "size.*0x3"),
        ({"size": "wide"}, "size.*WIDTHxHEIGHT"),
        ({"size": (3, 4, 5)}, "size"),
        ({"noise": float("nan")}, "noise.*NaN"),
        ({"time": 0}, "time.*0"),
        ({"seed": -1}, "seed"),
        ({"seed": 2**40}, "seed"),
        ({"integrator": "x"}, "integrator.*megakernel.*lvc"),
        ({"allocator": "x"}, "allocator.*uniform.*runs"),
        ({"estimator": "x"}, "estimator.*bilateral"),
        ({"denoise": "x"}, "denoise.*oidn"),
        ({"device": "abacus"}, "abacus.*cpu"),
        ({"device": "cpu:abacus"}, "cpu:abacus.*cpu:scalar"),
        ({"nothing": 1}, "no option 'nothing'; there are: allocator, .*time"),
        ({"output": "a.png"}, "no option 'output'"),
        ({"part": "4/4"}, "part.*4/4"),
        ({"sky": 200}, "sky.*200"),
        ({"environment_strength": 2}, "environment"),
    ],
    ids=str,
)
def test_options_are_checked(options, error):
    with pytest.raises(ValueError, match=error) as caught:
        rs.render("cornell_ball", **{"device": "cpu", **options})
    text = str(caught.value)
    assert "--" not in text and "\n" not in text and "error:" not in text


@pytest.mark.parametrize("value", [object(), {"a": 1}, b"x"], ids=str)
def test_options_are_of_types(value):
    with pytest.raises(TypeError, match="spp: takes no"):
        rs.render("cornell_ball", spp=value)


def test_values_may_be_of_numpy():
    options = {"size": (np.int64(8), np.uint8(6)), "spp": np.int32(2), "noise": np.float32(0.5)}
    assert rs.Renderer("cornell_ball", device="cpu", **options).size == (8, 6)
    flags = {"relative": np.bool_(False), "halves": False, "denoise": False, "time": None}
    for p in rs.Renderer("cornell_ball", **SMALL, **flags):
        pass
    assert p.denoised is None
    with pytest.raises(ValueError, match="0/3x"):
        rs.render("cornell_ball", **SMALL, part="0/3x")


def test_options_without_effect_are_warned_of():
    with pytest.warns(UserWarning, match="relative has no effect with allocator uniform"):
        rs.render("cornell_ball", **SMALL, allocator="uniform", relative=True)
    with pytest.warns(UserWarning, match="light_paths has no effect without the integrator lvc"):
        rs.Renderer("cornell_ball", **SMALL, light_paths=3)


def test_scenes_that_are_not_there():
    with pytest.raises(ValueError, match="no scene is called `nothing`; there are `cornell_ball`"):
        rs.load("nothing")
    with pytest.raises(FileNotFoundError, match="no/scene.json: cannot be read"):
        rs.load("no/scene.json")
    with pytest.raises(FileNotFoundError, match="no.hdr"):
        rs.load("cornell_ball", environment="no.hdr")
    with pytest.raises(ValueError, match="no camera is called `x`"):
        rs.load("cornell_ball", camera="x")
    with pytest.raises(TypeError):
        rs.load(3)
    assert "tea" in rs.scenes()


def test_scenes_that_are_wrong(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text('{"format": 2, "name": 3}')
    with pytest.raises(ValueError, match="scene.json: key `name`"):
        rs.load(path)
    with pytest.raises(OSError, match="folder"):
        rs.load(tmp_path)


def test_options_are_where_they_belong():
    with pytest.raises(ValueError, match="spp: is an option of render"):
        rs.load("cornell_ball", spp=3)
    with pytest.raises(ValueError, match="no option 'x'; there are: aperture, .*variant"):
        rs.load("cornell_ball", x=3)
    scene = rs.load("cornell_ball")
    with pytest.raises(ValueError, match=r"sky: is an option of load\(\)"):
        rs.render(scene, sky=30)
    assert "spp" in rs.options()[0] and "sky" in rs.options()[1]
    assert all(rs.options()[0].values()) and "--" not in str(rs.options())


def test_films_that_are_wrong(tmp_path):
    path = tmp_path / "a.film"
    for what in (rs.Film, rs.resume, lambda path: rs.merge([path])):
        with pytest.raises(FileNotFoundError, match="a.film: no such file"):
            what(path)
    path.write_bytes(b"nothing")
    for what in (rs.Film, rs.resume, lambda path: rs.merge([path])):
        with pytest.raises(ValueError, match="a.film: is not a film file"):
            what(path)
    with pytest.raises(ValueError, match="no film to merge"):
        rs.merge([])
    renderer = rs.Renderer("cornell_ball", **SMALL)
    renderer.save(path)
    with pytest.raises(ValueError, match="a.film: is not of a part"):
        rs.merge([path])
    with pytest.raises(ValueError, match="no option 'seed'; there are: device, noise, spp, time"):
        rs.resume(path, seed=3)
    with pytest.raises(OSError, match="there is no folder"):
        renderer.save(tmp_path / "no/a.film")
    with pytest.raises(ValueError, match="denoise: there is no 'x'|there is no 'x'; there are"):
        rs.Film(path).layers(denoise="x")
    cut = path.read_bytes()[:-40]
    path.write_bytes(cut)
    with pytest.raises(ValueError, match="a.film: is not a valid film file"):
        rs.Film(path)


def test_pictures_are_checked(tmp_path):
    image = np.zeros((3, 4, 3), dtype=np.float32)
    for path, layers, error in [
        ("a.jpg", image, "use .exr or .png"),
        ("a.exr", image[0, 0], r"color: has the shape \[3\]"),
        ("a.exr", np.zeros((3, 4, 5)), r"color: has the shape \[3, 4, 5\]"),
        ("a.exr", {}, "no layer to write"),
        ("a.exr", {"a": image, "b": image[1:]}, "b: is 2 high and 4 wide, but the other layers"),
        ("a.png", {"a": image}, "no layer to write"),
        ("a.png", image[:, :, 0], "no channels R, G, B"),
        ("a.exr", np.zeros((0, 4, 3)), "at least 1x1"),
        ("a.exr", "picture", "could not convert"),
    ]:
        with pytest.raises(ValueError, match=error):
            rs.write(tmp_path / path, layers)
    with pytest.raises(ValueError, match="no 'x'; there are: soft, clip, aces"):
        rs.write(tmp_path / "a.png", image, tone_map="x")
    with pytest.raises(ValueError, match="exposure: NaN is not"):
        rs.write(tmp_path / "a.png", image, exposure=float("nan"))
    with pytest.raises(FileNotFoundError, match="no such file"):
        rs.read(tmp_path / "a.exr")
    with pytest.raises(FileNotFoundError, match="there is no folder"):
        rs.write(tmp_path / "no/a.exr", image)
    (tmp_path / "b.exr").write_bytes(b"nothing")
    with pytest.raises(ValueError, match="b.exr: is not a valid EXR"):
        rs.read(tmp_path / "b.exr")
    assert [path.name for path in tmp_path.iterdir()] == ["b.exr"]


def test_pictures_come_back(tmp_path):
    random = np.random.default_rng(1)
    layers = {
        "color": random.normal(size=(5, 7, 3)).astype(np.float32),
        "normal": random.normal(size=(5, 7, 3)).astype(np.float32),
        "depth": np.full((5, 7), np.inf, dtype=np.float32),
        "own": random.normal(size=(5, 7)).astype(np.float32),
        "of.mine": random.normal(size=(5, 7, 3)).astype(np.float32),
    }
    rs.write(tmp_path / "a.exr", layers)
    read = rs.read(tmp_path / "a.exr")
    assert sorted(read) == sorted(layers)
    for name, layer in layers.items():
        np.testing.assert_array_equal(read[name], layer)
    # Of any type, in any order in memory.
    turned = np.asfortranarray(layers["color"].astype(np.float64))[::-1]
    rs.write(tmp_path / "b.exr", turned)
    np.testing.assert_array_equal(rs.read(tmp_path / "b.exr")["color"], layers["color"][::-1])
    image = np.clip(layers["color"], 0, 1)
    rs.write(tmp_path / "a.png", {"color": image + 9, "denoised": image}, tone_map="clip")
    np.testing.assert_allclose(rs.read(tmp_path / "a.png")["color"], image, atol=0.005)
