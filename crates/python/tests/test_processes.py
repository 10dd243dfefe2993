"""What is around a render: other threads, signals, memory."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest
import raystream as rs
from conftest import SMALL

LONG = {"size": (320, 240), "device": "cpu", "time": 60}


def interrupted(call):
    """Seconds from Ctrl-C to the end of a call."""
    sent = []

    def send():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(1.0, send)
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        call()
    timer.join()
    return time.monotonic() - sent[0]


def test_ctrl_c_ends_a_render_soon():
    # Without it, this would take a minute. A busy machine takes seconds for a batch.
    assert interrupted(lambda: rs.render("cornell_ball", **LONG)) < 20


def test_ctrl_c_ends_a_round_and_the_render_goes_on(tmp_path):
    renderer = rs.Renderer("cornell_ball", **{**LONG, "time": None, "spp": 4096})

    def iterate():
        for _ in renderer:
            pass

    # The round under way is finished.
    assert interrupted(iterate) < 20
    assert renderer.stop is None
    renderer.save(tmp_path / "a.film")
    assert rs.Film(tmp_path / "a.film").samples > 1


def test_a_render_that_was_interrupted_is_the_same_one():
    options = {**SMALL, "size": (160, 120), "spp": 300}
    whole = rs.render("cornell_ball", **options)
    renderer = rs.Renderer("cornell_ball", **options)
    timer = threading.Timer(0.4, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    times = 0
    while renderer.stop is None:
        try:
            for p in renderer:
                pass
        except KeyboardInterrupt:
            times += 1
    timer.cancel()
    assert times <= 1
    assert p.image.tobytes() == whole.tobytes()


def test_other_threads_go_on():
    """The lock is released: another thread counts while a render runs."""
    counted, ends = [0], threading.Event()

    def count():
        while not ends.is_set():
            counted[0] += 1
            time.sleep(0.005)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    rs.render("cornell_ball", **{**LONG, "time": 1.5})
    seconds = time.monotonic() - start
    ends.set()
    thread.join()
    # It would be none or one with the lock held; a loaded machine may take most of the turns.
    assert counted[0] > 20 * seconds


def test_renders_of_threads_are_those_of_one():
    scene = rs.load("cornell_ball")
    whole = [rs.render(scene, **{**SMALL, "seed": seed}).tobytes() for seed in range(4)]
    made = [b""] * 4

    def render(seed):
        made[seed] = rs.render(scene, **{**SMALL, "seed": seed}).tobytes()

    threads = [threading.Thread(target=render, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert made == whole


def test_threads_may_look_at_one_renderer():
    renderer = rs.Renderer("cornell_ball", **{**SMALL, "spp": 200})
    errors = []

    def look():
        for p in renderer:
            try:
                assert p.image.shape == (30, 40, 3)
            except RuntimeError as error:  # Another thread was faster.
                assert "is over" in str(error)
            except Exception as error:
                errors.append(error)

    threads = [threading.Thread(target=look) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors and renderer.stop == "samples"


def memory() -> int:
    """Bytes of the process that are in memory."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs Linux's /proc")
def test_a_thousand_renders_leave_nothing():
    """Memory does not grow from the 100th render to the 1100th.

    A line is fitted to the memory after every 50 renders. Its slope, and three of the slope's
    standard errors, must be less than 4 KiB a render: the picture alone of 40x30 pixels has 14 KiB,
    sums and features have 150 KiB.
    """
    scene = rs.load("cornell_ball")

    def turn():
        rs.render(scene, size=(40, 30), spp=1, device="cpu", allocator="uniform")

    def renderer():
        for p in rs.Renderer(scene, size=(40, 30), spp=7, device="cpu", denoise="gem"):
            p.layers()
        with pytest.raises(ValueError):
            rs.render(scene, spp=0)
        rs.Scene(
            camera=rs.Camera(origin=(0, 0, 4), target=(0, 0, 0), fov_y=40),
            meshes=[rs.Mesh(np.eye(3), [[0, 1, 2]])],
            background=[1, 1, 1],
        )

    def renders(count):
        for index in range(count):
            turn()
            if index % 10 == 0:
                renderer()

    renders(100)
    measured = []
    for _ in range(21):
        measured.append(memory())
        renders(50)
    steps = 50.0 * np.arange(21)
    line, residuals, *_ = np.polyfit(steps, measured, 1, full=True)
    spread = np.sum((steps - steps.mean()) ** 2)
    slope, error = line[0], np.sqrt(residuals.sum() / (len(steps) - 2) / spread)
    print(
        f"\nmemory {measured[0] / 2**20:.1f} to {measured[-1] / 2**20:.1f} MiB, "
        f"slope {slope:.0f} +- {error:.0f} bytes a render"
    )
    assert slope + 3 * error < 4096


def test_it_ends_with_its_process():
    """A process may end while a thread renders, and without a word."""
    code = """
        import threading, raystream as rs
        options = dict(size=(320, 240), device="cpu", time=60)
        threading.Thread(target=lambda: rs.render("cornell_ball", **options), daemon=True).start()
        next(rs.Renderer("cornell_ball", **options))
    """
    ended = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=60
    )
    assert (ended.returncode, ended.stderr, ended.stdout) == (0, "", "")
