"""Tests of tools/python/knap_convert.py: ctest runs them with KNAP and a directory; exit code 77: skipped."""
import contextlib
import io
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
        self.assertEqual(convert.mesh(folder / "specimen.inp", folder / "specimen.msh"), (5, 2, ["QUARTZ", "MICA"]))
        (folder / "specimen.toml").write_text(SCENE)
        check = knap_command("check", folder / "specimen.toml")
        self.assertEqual(check.returncode, 0, check.stdout + check.stderr)

    def test_the_finest_sets_that_partition_the_elements_are_surfaces(self):
        for sets, expected in (({"all": range(4), "steel": [0], "rock": [1, 2, 3]}, "steel rock rock rock"),
                               ({"all": range(4), "steel": [0], "rock": [1, 2, 3], "loaded": [3]}, "steel rock rock rock"),  # a part of rock alone
                               ({"all": range(4), "a": [0], "b": [1], "c": [2], "d": [3], "right": [1, 3]}, "a b c d"),
                               ({"left": [0, 1], "upper": [2]}, "left left upper -"),
                               ({"one": [0, 1, 2, 3], "same": [0, 1, 2, 3]}, "one one one one"), ({}, "- - - -")):
            own = convert.partition(sets.values(), 4)
            self.assertEqual(" ".join([*sets, "-"][k] for k in own), expected, sets)

    def test_materials_of_sections_name_the_surfaces_and_what_is_left_out_is_said(self):
        (folder / "sections.inp").write_text("*Node\n1,0,0\n2,1,0\n3,2,0\n4,0,1\n5,1,1\n6,2,1\n7,.5,0\n8,1,.5\n9,.5,1\n10,0,.5\n"
                                             "*Element, type=CPS8R, elset=EALL\n1, 1,2,5,4,7,8,9,\n10\n*Element, type=CPS4, elset=Eall\n2, 2,3,6,5\n"
                                             "*Elset, elset=left, generate\n1, 1, 1\n*ELSET, ELSET=right\n2\n"
                                             "*Surface, name=top, type=ELEMENT\n1, S3\n*Solid Section, elset=LEFT, material=Steel\n")
        with contextlib.redirect_stderr(io.StringIO()) as said:
            self.assertEqual(convert.mesh(folder / "sections.inp", folder / "sections.msh"), (4, 2, ["Steel", "right"]))
        for text in ("1 *SURFACE", "corners are kept of 1 quad8", "the sets EALL"):
            self.assertIn(text, said.getvalue())
        rows = (folder / "sections.msh").read_text().split("$Elements\n")[1].splitlines()
        self.assertEqual([row.split()[4] for row in rows[1:5]], ["2", "2", "3", "3"])  # entities: left, right

    def test_mistakes_of_an_abaqus_file_have_their_line(self):
        for change, message in ((("3, 3, 7, 6", "3, 3, 70, 6"), ":15: element 3 has the node 70"), (("CPE3", "C3D4"), ":14: the element type C3D4"),
                                (("3, 3, 7, 6", "2, 3, 7, 6"), ":15: element 2 is there before"), (("3, 3, 7, 6", "3, 3, 7"), ":16: .*too few nodes"),
                                (("7, 3., 0.", "7, x, 0."), ":9: .*not a number"), (("1, 2, 3, 7", "TOP"), ":17: there is no set TOP")):
            self.assertIn(change[0], ABAQUS)
            (folder / "bad.inp").write_text(ABAQUS.replace(*change))
            with self.assertRaisesRegex(knap.KnapError, "bad.inp" + message):
                convert.mesh(folder / "bad.inp", folder / "bad.msh")

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

    def test_noise_is_refused_with_its_cure(self):
        Image.fromarray(np.random.default_rng(1).integers(0, 255, (30, 30, 3), np.uint8)).save(folder / "noise.jpg")
        with self.assertRaisesRegex(knap.KnapError, r"has \d+ colours, more than 64 materials: --colours N"):
            convert.picture(folder / "noise.jpg", folder / "noise.png")
        self.assertFalse((folder / "noise.png").exists())
        for options, message in (({"colours": 0}, "0 colours"), ({"colours": 300}, "1 to 256"), ({"width": 0}, "0 pixels")):
            with self.assertRaisesRegex(knap.KnapError, message):
                convert.picture(folder / "noise.jpg", folder / "noise.png", **options)

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
