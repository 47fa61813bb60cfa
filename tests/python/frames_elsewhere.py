"""Frames of a run as others read them: `frames_elsewhere.py vtk|meshio|pyvista|paraview DIRECTORY`. All must find what knap.py finds.
Exit code 77: this reader is not installed."""
import pathlib
import shutil
import subprocess
import sys

reader, runs = sys.argv[1], pathlib.Path(sys.argv[2])
try:
    import numpy as np
    if reader == "vtk":
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
    elif reader == "meshio":
        import meshio
    elif reader == "pyvista":
        import pyvista
    elif not shutil.which("pvpython"):
        raise ImportError("there is no pvpython (Debian: paraview)")
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools" / "python"))
import knap  # noqa: E402


def arrays_of(grid):
    """Of a vtkUnstructuredGrid: points, cells, values by name."""
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    values = {}
    for data in (grid.GetPointData(), grid.GetCellData()):
        values.update({data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())})
    return vtk_to_numpy(grid.GetPoints().GetData()), cells, values


def by_vtk(file):
    read = vtk.vtkXMLUnstructuredGridReader()
    read.SetFileName(str(file))
    read.Update()
    return arrays_of(read.GetOutput())


def by_meshio(file):
    mesh = meshio.read(file)
    values = dict(mesh.point_data)
    values.update({name: np.concatenate(blocks) for name, blocks in mesh.cell_data.items()})
    return mesh.points, np.concatenate([block.data.ravel() for block in mesh.cells] or [[]]), values


def by_pyvista(file):
    mesh = pyvista.read(file)
    values = {name: np.asarray(data[name]) for data in (mesh.point_data, mesh.cell_data) for name in data}
    return np.asarray(mesh.points), np.asarray(mesh.cell_connectivity), values


def by_paraview(file):
    """pvpython is an interpreter of its own: it writes what it reads."""
    script, out = runs / "read.py", runs / "read.npz"
    script.write_text("""
import sys
import numpy as np
from paraview import servermanager
from paraview.simple import XMLUnstructuredGridReader
from vtk.util.numpy_support import vtk_to_numpy
grid = servermanager.Fetch(XMLUnstructuredGridReader(FileName=[sys.argv[1]]))
found = {"points": vtk_to_numpy(grid.GetPoints().GetData()), "cells": vtk_to_numpy(grid.GetCells().GetConnectivityArray())}
for data in (grid.GetPointData(), grid.GetCellData()):
    for i in range(data.GetNumberOfArrays()): found["array " + data.GetArrayName(i)] = vtk_to_numpy(data.GetArray(i))
np.savez(sys.argv[2], **found)
""")
    subprocess.run(["pvpython", "--force-offscreen-rendering", script, file, out], check=True)
    found = np.load(out)
    return found["points"], found["cells"], {name[6:]: found[name] for name in found if name.startswith("array ")}


read = {"vtk": by_vtk, "meshio": by_meshio, "pyvista": by_pyvista, "paraview": by_paraview}[reader]
disc = {"shape": "disc", "centre": ["30 mm", "2 mm"], "radius": "2 mm", "velocity": ["0 m/s", "0 m/s"], "spin": 0}
run = knap.run("bar_pulled_apart", {"mesh.size": "1 mm", "obstacle": [disc], "figure": [], "output.report": False, "expect": {}},
               runs / reader, threads=1)
n_arrays = n_empty = 0
for time in (run.frame_times[0], run.frame_times[-1]):
    frame, number = run.frame(time), int(np.argmin(np.abs(run.frame_times - time)))
    for part, grid in (("bulk", frame.bulk), ("interfaces", frame.interfaces), ("obstacles", frame.obstacles)):
        points, cells, values = read(run.directory / f"fields/{part}_{number:04}.vtu")
        n_empty += len(grid.points) == 0
        np.testing.assert_array_equal(points[:, :2], grid.points)
        np.testing.assert_array_equal(cells, grid.cells.ravel())
        assert set(grid) <= set(values), (part, sorted(grid), sorted(values))
        for name in grid:
            np.testing.assert_array_equal(np.asarray(values[name]).reshape(grid[name].shape), grid[name], err_msg=f"{part}: {name}")
            n_arrays += 1
assert n_arrays > 20 and n_empty == 1, (n_arrays, n_empty)  # the body has no crack at first
n_files = 0
for file in sorted((run.directory / "fields").glob("*.vtu")):  # every one is read, and a cracked frame of each compression
    read(file)
    n_files += 1
for compression in ("zlib", "lz4")[:1 if reader == "meshio" else 2]:
    packed = knap.run("bar_pulled_apart", {"mesh.size": "1 mm", "figure": [], "output.report": False, "output.compression": compression,
                                           "expect": {}}, runs / f"{reader}_{compression}", threads=1)
    for name, values in packed.frame().bulk.items(): np.testing.assert_array_equal(values, run.frame().bulk[name], err_msg=name)
    for part in ("bulk", "interfaces"): read(packed.directory / f"fields/{part}_{len(packed.frame_times) - 1:04}.vtu")
print(f"{reader} finds the same {n_arrays} arrays and reads {n_files} files")
