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
    assert os.path.exists(program), "cargo build --release -p raystream-web --example digests"
    done = subprocess.run([program, scene], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def test_every_kernel_writes_the_same_bytes_in_the_browser(visit):
    """All that all kernels of five renders write, of a scene that the host prepares alike."""
    here = visit().tab.evaluate(ASK, {"ask": "digests", "scene": "opening"})
    there = native("opening")
    assert here["scene"] == there["scene"], "the device is given the same scene"
    here, there = here["written"], there["written"]
    assert [(a, b) for a, b in zip(here, there) if a != b] == []
    assert len(here) == len(there) > 500
    kernels = {digest["kernel"] for digest in here}
    wanted = {"fill_runs", "trace_paths", "accumulate", "filter_errors", "weigh_deficits"}
    assert wanted <= kernels
    print(f"{len(here)} outputs of {len(kernels)} kernels are the same")


@pytest.mark.parametrize("scene", ["cornell_ball", "cornell_glass", "tea", "daylight"])
def test_stream_contributions_and_film_are_the_same_in_the_browser(visit, scene):
    """Of scenes, too, whose hierarchy is another one in the browser; all else is the same."""
    wanted = {"slots", "contributions", "film", "estimates", "errors", "weights", "starts"}
    here, there = visit().tab.evaluate(ASK, {"ask": "digests", "scene": scene}), native(scene)
    prepared = [dict(all["prepared"]) for all in (here, there)]
    for name in ("texels", "parameters"):
        assert prepared[0][name] == prepared[1][name], name
    both = [[one for one in all["written"] if one["binding"] in wanted] for all in (here, there)]
    here, there = both
    assert {digest["binding"] for digest in here} == wanted
    assert here == there


def test_other_digests_are_seen_as_other_ones(visit):
    here = visit().tab.evaluate(ASK, {"ask": "digests", "scene": "cornell_ball"})
    other = native("opening")
    assert here["scene"] != other["scene"]
    pairs = zip(here["written"], other["written"])
    assert [a for a, b in pairs if a["sha256"] != b["sha256"]]


def test_a_wrong_question_is_answered_by_what_is_wrong_with_it(visit):
    with pytest.raises(Exception, match="no scene is open"):
        visit().tab.evaluate(ASK, {"ask": "render", "milliseconds": 1})
