"""Tests of tools/python/knap_traces.py: ctest runs them with KNAP and a directory; exit code 77: skipped."""
import contextlib
import csv
import io
import pathlib
import subprocess
import sys
import unittest

from common import np, repo
import knap
import knap_traces as traces

folder = pathlib.Path(sys.argv.pop())
folder.mkdir(parents=True, exist_ok=True)
window = np.array([[0, 0], [10, 0], [10, 6], [0, 6]])


def lines(*ends):
    return [traces.Trace(np.array(e, float), str(i)) for i, e in enumerate(ends)]


class Numbers(unittest.TestCase):
    def test_a_grid_of_lines_has_its_exact_numbers(self):
        grid = lines(*[[[-1, y], [11, y]] for y in (1, 2, 3)], *[[[x, 0.5], [x, 5]] for x in (2, 4, 6, 8)])
        n = traces.statistics(grid, window)
        self.assertEqual((n["traces"], n["I"], n["Y"], n["X"], n["E"]), (7, 8, 0, 12, 6))
        self.assertAlmostEqual(n["P21"], (3 * 10 + 4 * 4.5) / 60, places=12)
        self.assertAlmostEqual(n["P20"], (14 - 6) / 2 / 60, places=12)
        self.assertAlmostEqual(n["C_L"], 2 * 12 / 4, places=12)
        self.assertAlmostEqual(n["C_B"], 48 / ((8 + 48) / 2), places=12)
        self.assertEqual(n.units["P21"], "m/m2")
        self.assertAlmostEqual(traces.p10(grid, (0, 2.5), (10, 2.5)), 0.4, places=12)

    def test_ends_on_a_trace_are_y_nodes_and_a_bend_is_none(self):
        t = lines([[1, 1], [5, 1], [9, 2]], [[3, 1], [3, 4]], [[3, 4], [5, 5]])
        n = traces.statistics(t, window)
        self.assertEqual((n["I"], n["Y"], n["X"]), (3, 1, 0))  # at (3, 4) a trace goes on
        self.assertAlmostEqual(traces.p10(lines([[2, 0], [2, 3], [3, 6]]), (0, 3), (10, 3)), 0.1)

    def test_a_trace_that_leaves_the_window_and_returns_is_two(self):
        inside = traces.clipped(lines([[1, 5], [3, 8], [5, 5]]), window)
        self.assertEqual(len(inside), 2)
        self.assertAlmostEqual(sum(map(traces.length, inside)), 2 / 3 * np.hypot(2, 3), places=12)

    def test_ends_on_the_box_of_the_traces_are_inside(self):
        two = lines([[0, 0], [5, 5]], [[0, 3], [2, 5]])
        n = traces.statistics(two)  # all four ends lie on the box
        self.assertEqual((n["traces"], n["I"], n["E"]), (2, 4, 0))
        self.assertAlmostEqual(n["P20"], 2 / 25, places=12)
        self.assertAlmostEqual(n["P21"], 7 * np.sqrt(2) / 25, places=12)
        cut = traces.statistics(two, traces.box(two))  # a window that was asked for cuts what ends on it
        self.assertEqual((cut["E"], cut["P20"]), (4, 0))
        longer = traces.statistics(lines([[-5, -5], [10, 10]]), traces.box(two), closed=True)
        self.assertEqual((longer["E"], longer["P20"]), (2, 0))
        with self.assertRaisesRegex(knap.KnapError, "no area"):
            traces.statistics(lines([[0, 0], [5, 0]]))

    def test_the_rose_has_the_whole_length(self):
        ends, length = traces.rose(lines([[0, 0], [1, 0]], [[0, 0], [0, 2]], [[1, 1], [0, 0]]), bins=4)
        np.testing.assert_allclose(length, [1, np.sqrt(2), 2, 0])
        np.testing.assert_allclose(ends, [0, 45, 90, 135, 180])


class Files(unittest.TestCase):
    def test_csv_returns_the_same_bits(self):
        some = [traces.Trace(np.array([[0.1, 1 / 3], [2, 3], [4, 5.5]]), "7", "fault")]
        traces.write(folder / "t.csv", some)
        again = traces.read(folder / "t.csv")
        self.assertEqual((again[0].name, again[0].kind), ("7", "fault"))
        np.testing.assert_array_equal(again[0].points, some[0].points)
        with self.assertRaises(knap.KnapError):
            (folder / "bad.csv").write_text("a,b\n1,2\n")
            traces.read(folder / "bad.csv")

    def test_geojson_has_the_same_lines_as_csv(self):
        (folder / "t.geojson").write_text('{"features": [{"properties": {"class": "a"}, "geometry": '
                                          '{"type": "MultiLineString", "coordinates": [[[0, 0], [1000, 0]], [[0, 1], [5, 5, 9]]]}}]}')
        found = traces.read(folder / "t.geojson", unit=1e-3)
        self.assertEqual([t.kind for t in found], ["a", "a"])
        np.testing.assert_allclose(found[0].points, [[0, 0], [1, 0]])
        traces.write(folder / "parts.csv", found)  # no bridge joins the parts
        self.assertEqual([len(t.points) for t in traces.read(folder / "parts.csv")], [2, 2])
        traces.write(folder / "parts.csv", [t._replace(name="one") for t in found])
        self.assertEqual(len(traces.read(folder / "parts.csv")), 2)

    def test_what_is_no_line_is_said(self):
        (folder / "p.geojson").write_text('{"features": [{"geometry": {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1], [0, 0]]]}}, '
                                          '{"geometry": {"type": "LineString", "coordinates": [[0, 0], [3, 4]]}}]}')
        with contextlib.redirect_stderr(io.StringIO()) as said:
            self.assertEqual(len(traces.read(folder / "p.geojson")), 1)
        self.assertIn("1 Polygon", said.getvalue())

    def test_csv_of_a_table_calculation_is_read_and_mistakes_have_their_line(self):
        (folder / "e.csv").write_text("\ufefftrace;x [km];y [km];class\n1;0;0;a # start\n1;3;4;a\n", encoding="utf-8")
        found = traces.read(folder / "e.csv")
        self.assertEqual((found[0].kind, traces.length(found[0])), ("a", 5000.0))
        for content, message in (("trace,x,y\n1,0,0\n1,east,2\n", ":3: x or y"), ("trace;x;y\n1;0,5;0\n", ":2: .*decimal commas"),
                                 ("trace,x,y\n1,0,0\n2,0,0\n2,1,1\n1,3,3\n", ":5: trace `1` goes on"), ("trace,x,y\n1,0,0\n", ":2: .*one point"),
                                 ("trace,x [mile],y\n", ":1: .*mile"), ("trace,x,y\n1,0\n", ":2: .*2 values for 3")):
            (folder / "bad.csv").write_text(content)
            with self.assertRaisesRegex(knap.KnapError, "bad.csv" + message):
                traces.read(folder / "bad.csv")

    def test_units_are_lengths(self):
        self.assertEqual([traces.metres(text) for text in ("1 km", "mm", "0.3048", "2.5e1m")], [1000, 1e-3, 0.3048, 25])
        for text in ("1 s", "0", "m km", "-1 m"):
            with self.assertRaisesRegex(knap.KnapError, "no length"):
                traces.metres(text)

    def test_dxf_has_its_layers_as_classes(self):
        try:
            import ezdxf
        except ImportError:
            self.skipTest("python3-ezdxf is not installed")
        drawing = ezdxf.new()
        drawing.modelspace().add_line((0, 0), (3, 4), dxfattribs={"layer": "faults"})
        drawing.modelspace().add_lwpolyline([(0, 0), (1, 0), (1, 1)], dxfattribs={"layer": "joints"})
        drawing.saveas(folder / "t.dxf")
        found = traces.read(folder / "t.dxf")
        self.assertEqual([(t.kind, traces.length(t)) for t in found], [("faults", 5.0), ("joints", 2.0)])

    def test_curves_of_a_dxf_become_lines_in_its_unit(self):
        try:
            import ezdxf
        except ImportError:
            self.skipTest("python3-ezdxf is not installed")
        drawing = ezdxf.new(units=4)  # mm
        space = drawing.modelspace()
        space.add_circle((0, 0), 2)
        space.add_arc((0, 0), 2, 0, 90)
        space.add_spline([(0, 0), (1, 1), (2, 0)])
        space.add_lwpolyline([(0, 0), (3, 0), (3, 4)], close=True)
        space.add_text("A")
        space.add_point((1, 1))
        space.add_point((2, 1))
        drawing.blocks.new("faults").add_line((0, 0), (3, 4))
        space.add_blockref("faults", (1, 1))
        drawing.saveas(folder / "curves.dxf")
        with contextlib.redirect_stderr(io.StringIO()) as said:
            found = traces.read(folder / "curves.dxf")
        self.assertIn("2 POINT, 1 TEXT", said.getvalue())
        self.assertIn("a unit is 0.001 m", said.getvalue())
        self.assertEqual(len(found), 5)
        for trace, expected in zip(found, (4e-3 * np.pi, 1e-3 * np.pi, None, 12e-3, 5e-3)):
            if expected:
                self.assertAlmostEqual(traces.length(trace) / expected, 1, delta=2e-3)
        self.assertAlmostEqual(traces.length(traces.read(folder / "curves.dxf", unit="1 m")[3]), 12)  # what was asked for

    def test_a_shapefile_is_read_and_degrees_are_refused(self):
        try:
            from osgeo import ogr, osr
        except ImportError:
            self.skipTest("python3-gdal is not installed")
        for code, name in ((2056, "metres"), (4326, "degrees")):
            system = osr.SpatialReference()
            system.ImportFromEPSG(code)
            source = ogr.GetDriverByName("GPKG").CreateDataSource(str(folder / f"{name}.gpkg"))
            layer = source.CreateLayer("lines", system, ogr.wkbLineString)
            layer.CreateField(ogr.FieldDefn("class", ogr.OFTString))
            feature = ogr.Feature(layer.GetLayerDefn())
            feature.SetField("class", "fault")
            feature.SetGeometry(ogr.CreateGeometryFromWkt("LINESTRING (0 0, 3 4)"))
            layer.CreateFeature(feature)
            source = layer = feature = None
        found = traces.read(folder / "metres.gpkg")
        self.assertEqual((found[0].kind, traces.length(found[0])), ("fault", 5.0))
        with self.assertRaises(knap.KnapError):
            traces.read(folder / "degrees.gpkg")


class WhatTheProgramMade(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.map = lines([[0.02, 0.01], [0.05, 0.03]], [[0.03, 0.03], [0.05, 0.01]], [[0.07, 0.01], [0.07, 0.03], [0.08, 0.035]])
        traces.write(folder / "map.csv", cls.map)
        (folder / "s.toml").write_text("""knap = 1
[domain]
shape = "rectangle"
size = ["100 mm", "40 mm"]
[mesh]
size = "2 mm"
[material.glass]
density = 2450
E = 32e9
nu = 0.2
[interface.default]
sigma_c = "3 MPa"
G_c = 3
[[traces]]
file = "map.csv"
KEYS
[time]
end = "2 us"
[output]
report = false
""")

    def scenario(self, keys):
        file = folder / ("joints.toml" if keys else "cracks.toml")
        file.write_text((folder / "s.toml").read_text().replace("KEYS", keys))
        return file

    def test_the_mesh_follows_the_map(self):
        subprocess.run([knap.program(), "mesh", self.scenario('interface = "weak"\n[interface.weak]\nsigma_c = "1 MPa"\nG_c = 1'), "-o", folder / "m.msh", "--force"], check=True, capture_output=True)
        meshed = traces.read(folder / "m.msh")
        self.assertEqual({t.kind for t in meshed}, {"joint0"})
        box = np.array([[0, 0], [0.1, 0], [0.1, 0.04], [0, 0.04]])
        drawn, found = traces.statistics(self.map, box), traces.statistics(meshed, box)
        for name in ("P21", "I", "Y", "X", "C_B"):
            self.assertAlmostEqual(found[name], drawn[name], delta=1e-9, msg=name)

    def test_cracks_of_a_run_are_lines(self):
        run = knap.run(self.scenario(""), out=folder / "run", threads=1)
        cracks = traces.read(run.directory)
        self.assertAlmostEqual(sum(map(traces.length, cracks)), sum(map(traces.length, self.map)), delta=1e-6)
        self.assertEqual({t.kind for t in cracks}, {"cracked from the start"})

    def test_the_command_prints_a_table(self):
        out = subprocess.run([sys.executable, repo / "tools" / "python" / "knap_traces.py", folder / "map.csv", "--scanline", "0", "0.02", "0.1", "0.02"],
                             capture_output=True, text=True, check=True).stdout
        rows = {row[0]: row[1] for row in csv.reader(out.splitlines())}
        self.assertEqual(rows["traces"], "3")
        self.assertEqual(float(rows["P10 [1/m]"]), 30)

    def test_a_reader_that_ends_early_ends_the_command_without_a_word(self):
        command = subprocess.Popen([sys.executable, repo / "tools" / "python" / "knap-traces", folder / "map.csv"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        command.stdout.close()
        self.assertEqual((command.stderr.read(), command.wait()), (b"", 141))
        command.stderr.close()


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
