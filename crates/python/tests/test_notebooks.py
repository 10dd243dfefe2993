"""The notebooks run, and are kept without their outputs."""

from __future__ import annotations

import pathlib

import nbclient
import nbformat
import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[1] / "examples"
NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))
# Each in seconds; what is looked at is whether it runs, not its figures.
SMALL = {
    "FIGURE_SIZE": "64x48",
    "FIGURE_SECONDS": "1.5",
    "FIGURE_REFERENCE_SPP": "512",
    "FIGURE_DEVICE": "cpu",
}


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.name)
# Those of Jupyter's own libraries.
@pytest.mark.filterwarnings("ignore")
def test_a_notebook_runs(path, monkeypatch):
    for name, value in SMALL.items():
        monkeypatch.setenv(name, value)
    notebook = nbformat.read(path, as_version=4)
    for cell in notebook.cells:
        assert not cell.get("outputs") and not cell.get("execution_count"), "outputs are kept"
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) >= 2
    assert not [output for output in outputs if output.get("name") == "stderr"], outputs


def test_there_is_a_notebook():
    assert [path.name for path in NOTEBOOKS] == ["figure-2.ipynb"]
