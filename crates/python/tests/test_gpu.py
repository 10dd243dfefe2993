"""The GPU: what the command makes on it, exactly what the CPU makes, and the same by statistics.

Without a GPU, a software one of Mesa will do; with RAYSTREAM_REQUIRE_GPU set, none is a failure.
"""

from __future__ import annotations

import math
import os
import statistics

import numpy as np
import pytest
import raystream as rs
from conftest import same

# Small: a software GPU is slow, and compiles its kernels first.
SMALL = {"size": (16, 12), "spp": 8, "device": "gpu", "seed": 3}


@pytest.fixture(autouse=True, scope="module")
def gpu() -> str:
    """The GPU's name."""
    found = [device for device in rs.devices() if device["kind"].endswith("GPU")]
    if not any(device["unsuitable"] is None for device in found):
        reasons = [f"{device['name']}: {device['unsuitable']}" for device in found]
        missing = f"there is no GPU that can be used: {'; '.join(reasons) or 'none is found'}"
        if "RAYSTREAM_REQUIRE_GPU" in os.environ:
            pytest.fail(f"RAYSTREAM_REQUIRE_GPU is set, but {missing}")
        pytest.skip(f"NOT TESTED: {missing} (mesa-vulkan-drivers has a software one)")
    return rs.Renderer("cornell_ball", **SMALL).device


def test_the_device_is_a_gpu(gpu):
    assert any(device["name"] in gpu for device in rs.devices() if device["kind"] != "CPU")
    assert not gpu.startswith("CPU")


@pytest.mark.parametrize(
    "options",
    [
        {"allocator": "uniform"},
        {"allocator": "runs", "integrator": "streaming", "denoise": "bilateral"},
    ],
    ids=str,
)
def test_the_layers_are_those_of_the_command(options, rendered):
    options = {**SMALL, **options}
    for p in rs.Renderer("cornell_ball", **options):
        pass
    layers = rendered("cornell_ball", options)
    assert sorted(p.names) == sorted(layers)
    for name, layer in p.layers().items():
        same(layer, layers[name])


def test_an_exact_gpu_makes_the_bytes_of_the_cpu():
    options = {**SMALL, "allocator": "runs"}
    for p in rs.Renderer("cornell_ball", **options, exact=True):
        pass
    for q in rs.Renderer("cornell_ball", **{**options, "device": "cpu"}):
        pass
    assert p.names == q.names
    for name, layer in p.layers().items():
        same(layer, q[name])


def test_gpu_and_cpu_have_the_same_expectation():
    """By z-tests of the picture and of its blocks of 4x4 pixels, by component; the limit is
    Bonferroni's for a false alarm in 1 of 10^4 runs, or in fewer: the points are spread more evenly
    than independent ones, whose variance is taken for theirs."""
    options = {**SMALL, "spp": 2048, "allocator": "uniform"}
    sums = []
    for changes in ({}, {"device": "cpu", "seed": 4}):
        for p in rs.Renderer("cornell_ball", **{**options, **changes}):
            pass
        sums.append([regions(p["color"]), regions(p["variance"])])
    (a, variance_a), (b, variance_b) = sums
    limit = statistics.NormalDist().inv_cdf(1 - 0.5e-4 / a.size)
    error = np.sqrt(variance_a + variance_b)
    # Where nothing but the lamp's own light is seen there is no variance, but rounding.
    assert (abs(a - b) <= limit * error + 1e-5 * np.maximum(a, b)).all()
    # A picture brighter by a tenth would be found.
    assert (abs(1.1 * a - b) > limit * error).any()


def regions(layer: np.ndarray) -> np.ndarray:
    """Sums over the picture and over its blocks of 4x4 pixels, by component."""
    height, width, components = layer.shape
    layer = layer.astype(np.float64)
    blocks = layer.reshape(height // 4, 4, width // 4, 4, components).sum(axis=(1, 3))
    return np.concatenate([layer.sum(axis=(0, 1))[None], blocks.reshape(-1, components)])
