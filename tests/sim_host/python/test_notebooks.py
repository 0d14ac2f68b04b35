"""The notebooks run to their end without a screen, and find what they tell."""
import base64
import re
import struct

import nbclient
import nbformat
import pytest

from package_tree import ROOT

NOTEBOOKS = ROOT / "sim_host/python/notebooks"


@pytest.fixture
def run(environment, monkeypatch, tmp_path):
    """Executes a notebook; (what it printed, its pictures' sizes)."""
    monkeypatch.setenv("PYTHONPATH", environment["PYTHONPATH"])
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path / "runtime"))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    monkeypatch.setenv("PYDEVD_DISABLE_FILE_VALIDATION", "1")

    def execute(name):
        notebook = nbformat.read(NOTEBOOKS / f"{name}.ipynb", 4)
        nbclient.NotebookClient(notebook, timeout=240, kernel_name="python3",
                                resources={"metadata": {"path": str(tmp_path)}}).execute()
        outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
        text = "\n".join(output.get("text", "") + output.get("data", {}).get("text/plain", "") for output in outputs)
        pictures = [base64.b64decode(output["data"]["image/png"]) for output in outputs if "image/png" in output.get("data", {})]
        return text, [struct.unpack(">II", picture[16:24]) for picture in pictures]
    return execute


def test_the_paper_in_thirty_lines(run):
    text, pictures = run("paper_in_thirty_lines")
    assert "[-0.407  -0.0596  1.7568]" in text and re.search(r"\[-0\.5714 -0\.1102 -?0\.\s*\]", text)
    assert len(pictures) == 2 and all(width > 1000 for width, _ in pictures)
    code = [line for cell in nbformat.read(NOTEBOOKS / "paper_in_thirty_lines.ipynb", 4).cells if cell.cell_type == "code"
            for line in cell.source.splitlines() if line.strip() and not line.startswith(("import ", "#"))]
    assert len(code) <= 30


def test_my_law_against_eq_16(run):
    text, pictures = run("my_law_against_eq16")
    largest = {name: float(value) for name, value in re.findall(r"(eq\. \(16\)|mine) +largest eigenvalue at 0\.8 rad/s: (\S+)", text)}
    assert largest["eq. (16)"] == pytest.approx(0.76, abs=0.02) and largest["mine"] < 0.3
    assert "('eq16', 0.02): 'falls'" in text and "('mine', 0.02): 'walks on'" in text and len(pictures) == 1


@pytest.mark.parametrize("path", sorted(NOTEBOOKS.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_what_it_printed(path):
    assert all(not cell.get("outputs") and cell.get("execution_count") is None for cell in nbformat.read(path, 4).cells)
