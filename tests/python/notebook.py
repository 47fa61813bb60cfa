"""The notebook of tools/python runs from the first to the last cell: `notebook.py DIRECTORY`. Exit code 77: nothing here executes one."""
import pathlib
import sys

try:
    import nbclient
    import nbformat
    import ipykernel  # noqa: F401
    import numpy  # noqa: F401
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-nbclient, python3-ipykernel, python3-numpy)")
    sys.exit(77)

runs = pathlib.Path(sys.argv[1])
runs.mkdir(parents=True, exist_ok=True)
tools = pathlib.Path(__file__).resolve().parents[2] / "tools" / "python"
notebook = nbformat.read(tools / "first_run.ipynb", as_version=4)
assert not any(cell.get("outputs") for cell in notebook.cells), "the notebook is stored without results"
notebook.cells.insert(0, nbformat.v4.new_code_cell(f"import sys; sys.path.insert(0, {str(tools)!r})"))
nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(runs)}}).execute()
results = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs if output.output_type == "execute_result"]
page = results[0]["data"]["text/html"]
for words in ("bar_pulled_apart", "done", "data:image/png;base64,", "<td>dissipated</td><td>12 mJ</td>"): assert words in page, words
assert results[1]["data"]["text/plain"].startswith("(0.012"), results[1]
assert float(results[2]["data"]["text/plain"].removeprefix("np.float64(").rstrip(")")) < 1e-12, results[2]
print(f"{len(results)} cells with results")
