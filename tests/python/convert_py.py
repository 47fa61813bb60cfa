"""Tests of tools/python/knap_convert.py: ctest runs them with KNAP and a directory; exit code 77: skipped."""
import pathlib
import subprocess
import sys
import unittest

try:
    import meshio  # noqa: F401
    import numpy as np
    from PIL import Image
except ImportError as error:
    print(f"skipped: {error} (Debian: python3-numpy python3-meshio python3-pil)")
    sys.exit(77)

repo = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(repo / "tools" / "python"))
import knap  # noqa: E402
import knap_convert as convert  # noqa: E402

folder = pathlib.Path(sys.argv.pop())
folder.mkdir(parents=True, exist_ok=True)

ABAQUS = """*HEADING
*NODE
1, 0., 0.
2, 1., 0.
3, 2., 0.
4, 0., 1.
5, 1., 1.
6, 2., 1.
7, 3., 0.
*ELEMENT, TYPE=CPE4, ELSET=QUARTZ
1, 1, 2, 5, 4
*ELEMENT, TYPE=CPE4, ELSET=MICA
2, 2, 3, 6, 5
*ELEMENT, TYPE=CPE3, ELSET=MICA
3, 3, 7, 6
*NSET, NSET=BASE
1, 2, 3, 7
"""
SCENE = """knap = 1
[mesh]
file = "specimen.msh"
unit = "1 cm"
[material.QUARTZ]
density = 2600
E = 80e9
nu = 0.1
[material.MICA]
density = 2800
E = 60e9
nu = 0.2
[interface.default]
breakable = false
[[load]]
on = "BASE"
displacement = [0, 0]
[time]
end = "1 us"
"""


class Meshes(unittest.TestCase):
    def test_an_abaqus_file_becomes_a_mesh_that_knap_runs(self):
        (folder / "specimen.inp").write_text(ABAQUS)
        self.assertEqual(convert.mesh(folder / "specimen.inp", folder / "specimen.msh"), (5, 2))
        (folder / "specimen.toml").write_text(SCENE)
        check = knap_command("check", folder / "specimen.toml")
        self.assertEqual(check.returncode, 0, check.stdout + check.stderr)

    def test_a_quadrangle_is_cut_where_its_triangles_are_best(self):
        points = np.array([[0, 0], [3, 1], [4, 4], [1, 3]], float)  # its short diagonal joins 1 and 3
        cut = convert.cut([[0, 1, 2, 3]], points)
        self.assertEqual({tuple(sorted(t)) for t in cut.tolist()}, {(0, 1, 3), (1, 2, 3)})
        arrow = np.array([[0, 0], [2, 1], [0, 2], [0.5, 1]], float)  # concave at the last one
        cut = convert.cut([[0, 1, 2, 3]], arrow)
        area = convert._cross(arrow[cut[:, 1]] - arrow[cut[:, 0]], arrow[cut[:, 2]] - arrow[cut[:, 0]]) / 2
        self.assertTrue((area > 0).all())
        self.assertAlmostEqual(area.sum(), 1.5)
        with self.assertRaisesRegex(knap.KnapError, "sides cross"):
            convert.cut([[0, 1, 2, 3]], np.array([[0, 0], [1, 1], [1, 0], [0, 1]], float))

    def test_a_mesh_of_tetrahedra_is_refused_with_its_type(self):
        meshio.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0]], [("tetra", [[0, 1, 2, 3]])]).write(folder / "solid.vtk")
        with self.assertRaisesRegex(knap.KnapError, "tetra"):
            convert.mesh(folder / "solid.vtk", folder / "solid.msh")


class Pictures(unittest.TestCase):
    def test_a_jpeg_loses_the_mixtures_of_its_borders(self):
        pixels = np.zeros((40, 60, 3), np.uint8)
        pixels[:, :25], pixels[:, 25:] = (200, 60, 40), (30, 90, 160)
        Image.fromarray(pixels).save(folder / "two.jpg", quality=80)
        colours = convert.picture(folder / "two.jpg", folder / "two.png", colours=2)
        self.assertEqual(len(colours), 2)
        back = np.asarray(Image.open(folder / "two.png").convert("RGB"))
        self.assertEqual(len(np.unique(back.reshape(-1, 3), axis=0)), 2)
        self.assertLessEqual(abs((back[:, :, 0] > 128).mean() - 25 / 60), 0.02)

    def test_grey_levels_of_16_bits_fill_those_of_8(self):
        Image.fromarray(np.array([[1000, 2000], [3000, 3000]], np.uint16)).save(folder / "deep.tif")
        self.assertEqual(convert.picture(folder / "deep.tif", folder / "deep.png"), ["#ffffff", "#000000", "#808080"])

    def test_the_command_names_what_is_wrong(self):
        (folder / "no.tif").write_text("no picture")
        run = subprocess.run([sys.executable, repo / "tools/python/knap_convert.py", folder / "no.tif", folder / "no.png"],
                             capture_output=True, text=True)
        self.assertEqual(run.returncode, 1)
        self.assertIn("no.tif: Pillow cannot read it", run.stderr)


def knap_command(*arguments):
    import os
    return subprocess.run([os.environ["KNAP"], *arguments], capture_output=True, text=True)


if __name__ == "__main__":
    unittest.main()
