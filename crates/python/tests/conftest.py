"""What the tests share: a small render, and the command that must make the same one."""

from __future__ import annotations

import os
import pathlib
import subprocess
from typing import Any

import numpy as np
import pytest
import raystream as rs

ROOT = pathlib.Path(__file__).resolve().parents[3]

# Small, and on the device whose bits are the same everywhere.
SMALL = {"size": (40, 30), "spp": 24, "device": "cpu", "seed": 3}


def same(a: np.ndarray, b: np.ndarray) -> None:
    """Two layers are the same, bit for bit."""
    assert a.dtype == b.dtype == np.float32
    assert a.shape == b.shape
    assert a.tobytes() == b.tobytes()


def command() -> str:
    """The program `raystream`, of the same sources."""
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    program = os.environ.get("RAYSTREAM", str(target / "release/raystream"))
    if not os.path.exists(program):
        pytest.fail(f"{program}: not there; build it (cargo build --release), or set RAYSTREAM")
    return program


def words(options: dict[str, Any]) -> list[str]:
    """Keywords as options of the command."""
    made = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if isinstance(value, tuple):
            value = "x".join(map(str, value))
        made.append(option if value is True else f"{option}={value}")
    return made


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs `raystream`."""
    return subprocess.run([command(), *arguments], check=True, capture_output=True, text=True)


@pytest.fixture
def rendered(tmp_path: pathlib.Path):
    """Renders by the command: the layers of its EXR."""

    def render(scene: str, options: dict[str, Any]) -> dict[str, Any]:
        path = tmp_path / "command.exr"
        run("render", scene, "-q", "-o", str(path), *words(options))
        return rs.read(path)

    return render
