"""Kernels in the browser compute what they compute natively, bit for bit."""

import json
import os
import subprocess

import pytest

from conftest import ROOT

# Asks a worker of its own: the page need not be shown for it.
ASK = """question => new Promise((resolve, reject) => {
  const worker = new Worker('worker.js', { type: 'module' });
  worker.onmessage = ({ data }) => {
    if (data.kind === 'known') worker.postMessage({ kind: 'ask', id: 1, question });
    if (data.kind === 'problem') reject(new Error(data.message));
    if (data.kind === 'answer') resolve(data.answer);
  };
})"""


def native(scene):
    target = os.environ.get("CARGO_TARGET_DIR", ROOT / "target")
    program = os.path.join(target, "release", "examples", "digests")
    done = subprocess.run([program, scene], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


@pytest.mark.parametrize("scene", ["cornell_ball", "daylight", "tea"])
def test_every_kernel_writes_the_same_bytes_in_the_browser(visit, scene):
    here = visit().tab.evaluate(ASK, {"ask": "digests", "scene": scene})
    there = native(scene)
    differing = [(a, b) for a, b in zip(here, there) if a != b]
    assert differing == []
    assert len(here) == len(there) > 1000
    kernels = {digest["kernel"] for digest in here}
    wanted = {"fill_runs", "trace_paths", "accumulate", "filter_errors", "weigh_deficits"}
    assert wanted <= kernels
    print(f"{len(here)} outputs of {len(kernels)} kernels are the same")


def test_other_digests_are_seen_as_other_ones(visit):
    here = visit().tab.evaluate(ASK, {"ask": "digests", "scene": "cornell_ball"})
    other = native("opening")
    assert [a for a, b in zip(here, other) if a["sha256"] != b["sha256"]]


def test_a_wrong_question_is_answered_by_what_is_wrong_with_it(visit):
    with pytest.raises(Exception, match="no scene is open"):
        visit().tab.evaluate(ASK, {"ask": "render", "milliseconds": 1})
