"""render() and Renderer make the bytes that `raystream render` makes."""

from __future__ import annotations

import numpy as np
import pytest
import raystream as rs
from conftest import SMALL, run, same

OPTIONS = [
    {"allocator": "uniform"},
    {"allocator": "runs"},
    {"allocator": "runs", "denoise": "bilateral", "integrator": "regeneration"},
    {"allocator": "paper", "estimator": "halves", "relative": True, "initial_spp": 2},
    {"integrator": "lvc", "max_depth": 4, "noise": 0.3},
]


@pytest.mark.parametrize("options", OPTIONS, ids=str)
@pytest.mark.filterwarnings("ignore:the error that noise asks for")
def test_the_pixels_are_those_of_the_command(options, rendered):
    options = {**SMALL, **options}
    image = rs.render("cornell_ball", **options)
    assert image.shape == (30, 40, 3)
    layers = rendered("cornell_ball", options)
    same(image, layers["denoised" if "denoise" in options else "color"])


@pytest.mark.parametrize("options", OPTIONS, ids=str)
@pytest.mark.parametrize("looks", [False, True])
def test_rounds_end_with_the_layers_of_the_command(options, looks, rendered):
    options = {**SMALL, **options}
    renderer = rs.Renderer(rs.load("cornell_ball"), **options)
    before = 0.0
    for p in renderer:
        assert p.samples > before
        before = p.samples
        if looks:  # What is looked at does not change what comes.
            assert p.image.shape == (30, 40, 3)
            assert p.error is None or p.error > 0
    layers = rendered("cornell_ball", options)
    assert sorted(p.names) == sorted(layers)
    for name, layer in p.layers().items():
        same(layer, layers[name])
    assert renderer.stop in ("samples", "noise")
    assert next(renderer, None) is None


def test_layers_have_the_shapes_of_pixels():
    for p in rs.Renderer("cornell_ball", **SMALL):
        pass
    for name in ("color", "plain", "variance", "albedo", "normal", "position", "filtered"):
        assert p[name].shape == (30, 40, 3), name
    for name in ("samples", "depth", "error"):
        assert p[name].shape == (30, 40), name
    assert p["samples"].sum() == 24 * 30 * 40 == round(p.samples * 1200)
    assert p.number >= 2 and p.rays > 24 * 1200 and p.seconds > 0
    assert 0 < p.error < 1 and p.denoised is None
    assert "albedo" in p and "nothing" not in p
    with pytest.raises(KeyError, match="no layer 'nothing'; there are: color"):
        p["nothing"]
    np.testing.assert_array_equal(p.image, p["color"])


def test_a_round_that_is_over_is_not_looked_at():
    renderer = rs.Renderer("cornell_ball", **SMALL)
    first = next(renderer)
    image = first.image
    next(renderer)
    with pytest.raises(RuntimeError, match="round 1 is over"):
        first["color"]
    assert image.shape == (30, 40, 3) and first.samples == 5


def test_time_and_noise_end_a_render():
    renderer = rs.Renderer("cornell_ball", size=(40, 30), device="cpu", time=0.3)
    for p in renderer:
        pass
    assert renderer.stop == "time" and 0.2 < p.seconds < 3
    renderer = rs.Renderer("cornell_ball", size=(40, 30), device="cpu", noise=0.2)
    for p in renderer:
        pass
    assert renderer.stop == "noise" and p.error <= 0.2


def test_a_device_is_named():
    renderer = rs.Renderer("cornell_ball", **SMALL)
    assert "cpu" in renderer.device.lower()
    assert renderer.size == (40, 30)
    assert any(device["name"] == "cpu" for device in rs.devices())


def test_a_render_that_goes_on_is_one_render(tmp_path):
    film = tmp_path / "a.film"
    whole = list(rs.Renderer("cornell_ball", **SMALL))[-1]
    renderer = rs.Renderer("cornell_ball", **SMALL)
    next(renderer), next(renderer)
    renderer.save(film)
    for p in rs.resume(film):
        pass
    assert p.samples == 24
    for name, layer in whole.layers().items():
        same(layer, p[name])


def test_a_look_at_the_end_is_not_in_the_film(tmp_path):
    films = tmp_path / "a.film", tmp_path / "b.film"
    for film, looks in zip(films, (False, True)):
        renderer = rs.Renderer("cornell_ball", **SMALL)
        for p in renderer:
            pass
        if looks:
            p.layers()
        renderer.save(film)
    same(*(rs.resume(film, spp=48) and rs.Film(film)["albedo"] for film in films))
    goes_on = [list(rs.resume(film, spp=48))[-1].layers() for film in films]
    for name, layer in goes_on[0].items():
        same(layer, goes_on[1][name])


def test_the_command_goes_on_with_films_and_we_with_its(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    renderer = rs.Renderer("cornell_ball", **SMALL)
    next(renderer)
    renderer.save("ours.film")
    run("resume", "ours.film", "-q", "-o", "ours.exr")
    options = ["--size=40x30", "--device=cpu", "--seed=3", "-q", "-o", "x.png"]
    run("render", *options, "--spp=5", "--checkpoint=theirs.film")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    for p in rs.resume("../theirs.film", spp=24):
        pass
    ours = rs.read("../ours.exr")
    for name, layer in p.layers().items():
        same(layer, ours[name])


def test_parts_are_one_render(tmp_path):
    options = {**SMALL, "allocator": "uniform"}
    films = []
    for part in range(3):
        renderer = rs.Renderer("cornell_ball", **options, part=(part, 3))
        for _ in renderer:
            pass
        films.append(tmp_path / f"{part}.film")
        renderer.save(films[-1])
    merged = rs.merge(films[::-1])
    whole = rs.render("cornell_ball", **options)
    same(merged.image, whole)
    assert merged.samples == 24 and merged.size == (40, 30)
    assert merged.parts == ["0/3", "1/3", "2/3"] and merged.scene == "cornell_ball"
    merged.save(tmp_path / "all.film")
    same(rs.Film(tmp_path / "all.film")["color"], whole)
    for p in rs.resume(tmp_path / "all.film", spp=30):
        pass
    same(p.image, rs.render("cornell_ball", **{**options, "spp": 30}))
    with pytest.warns(UserWarning, match="1 of 3 parts are missing"):
        rs.merge(films[:2])


def test_a_film_is_filtered(tmp_path):
    renderer = rs.Renderer("cornell_ball", **SMALL, denoise=True)
    for p in renderer:
        pass
    renderer.save(tmp_path / "a.film")
    layers = rs.Film(tmp_path / "a.film").layers(denoise="auto")
    assert layers["denoised"].shape == (30, 40, 3)
    assert "denoised" in p and p.denoised is not None


def test_environments_are_of_loading(tmp_path):
    plain = rs.render("cornell_ball", **SMALL)
    lit = rs.render("cornell_ball", **SMALL, sky=30, environment_strength=0.04)
    assert lit.mean() > plain.mean()
    scene = rs.load("cornell_ball", sky=30, environment_strength=0.04)
    same(rs.render(scene, **SMALL), lit)
    film = tmp_path / "sky.film"
    renderer = rs.Renderer(scene, **SMALL)
    next(renderer)
    renderer.save(film)
    same(list(rs.resume(film))[-1].image, lit)
