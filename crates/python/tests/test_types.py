"""The types and the documentation are complete."""

from __future__ import annotations

import inspect
import pathlib
import subprocess
import sys

import raystream as rs

HERE = pathlib.Path(__file__).parent


def run(*arguments: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-m", *arguments], capture_output=True, text=True, cwd=HERE
    )
    assert ended.returncode == 0, ended.stdout + ended.stderr


def test_a_sample_has_the_types_that_it_says():
    run("mypy", "--strict", "--warn-unused-ignores", "sample_types.py")


def test_stubs_are_what_there_is():
    run("mypy.stubtest", "raystream", "--allowlist", str(HERE / "stubtest-allowed.txt"))


def test_everything_is_documented():
    for name in rs.__all__:
        thing = getattr(rs, name)
        if name == "__version__":
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if not member.startswith("_") and member != "type":
                    assert inspect.getdoc(value), f"{name}.{member}"
