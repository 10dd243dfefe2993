"""What Python costs: user time of the same render by rs.render() and by `raystream render`.

    python bench/overhead.py [RAYSTREAM] [TURNS]

Both are whole processes, in turns; both load the scene, render and write the picture. The import of
numpy, which is paid once in a process, is measured by itself and taken off.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile

RENDER = dict(size="320x240", spp=256, device="cpu")


def user_seconds(*command: str) -> float:
    """User time of a process, its threads together."""
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    assert status == 0, command
    return usage.ru_utime


def main() -> None:
    program = sys.argv[1] if len(sys.argv) > 1 else "raystream"
    turns = int(sys.argv[2]) if len(sys.argv) > 2 else 7
    picture = os.path.join(tempfile.mkdtemp(), "a.png")
    words = [f"--{name}={value}" for name, value in RENDER.items()]
    imports = "import numpy, raystream as rs"
    call = f"{imports}; rs.write({picture!r}, rs.render('cornell_ball', **{RENDER}))"
    commands = {
        "raystream render": [program, "render", "cornell_ball", "-q", "-o", picture, *words],
        "rs.render()": [sys.executable, "-c", call],
        "imports": [sys.executable, "-c", imports],
    }
    seconds: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(turns):
        for name, command in commands.items():
            seconds[name].append(user_seconds(*command))
    median = {name: statistics.median(values) for name, values in seconds.items()}
    for name, values in seconds.items():
        print(f"{name:18} {median[name]:7.3f} s  ({min(values):.3f} to {max(values):.3f})")
    work = median["rs.render()"] - median["imports"]
    print(f"overhead {100 * (work / median['raystream render'] - 1):+.2f} %, of {turns} turns")


if __name__ == "__main__":
    main()
