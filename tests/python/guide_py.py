"""The recipes of the guide for rock as it is mapped do what they say: each is taken from scenarios/README.md, put behind a body with the
files that it names, and run. ctest runs this with KNAP and a directory; exit code 77: skipped."""
import contextlib
import io
import pathlib
import shutil
import struct
import subprocess
import sys
import unittest
import zlib

from common import np, repo, tools
import knap

folder = pathlib.Path(sys.argv.pop())
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
guide = (repo / "scenarios" / "README.md").read_text()
minerals = "".join(f"[material.{name}]\ndensity = 2700\nE = '50 GPa'\nnu = 0.2\n" for name in ("quartz", "mica"))
law = "sigma_c = '10 MPa'\nG_c = '100 J/m2'\n"


def recipe(part):
    """The indented block of the guide that has this part."""
    blocks = [[]]
    for line in guide.splitlines():
        if line.startswith("    "):
            blocks[-1].append(line[4:])
        elif blocks[-1]:
            blocks.append([])
    found = ["\n".join(block) + "\n" for block in blocks if part in "\n".join(block)]
    assert len(found) == 1, (part, len(found))
    return found[0]


def scene(name, text, body, more=""):
    """A scenario file of this recipe; tables of `more` that the recipe has go into its own."""
    for table in more.split("\n\n"):
        head, _, keys = table.partition("\n")
        has_it = head and not head.startswith("[[") and head + "\n" in text
        text = text.replace(head + "\n", head + "\n" + keys + "\n") if has_it else text + table + "\n"
    rest = "" if "\n[interface.default]\n" in text else f"[interface.default]\n{law}"
    file = folder / f"{name}.toml"
    file.write_text(f"knap = 1\nname = '{name}'\n{body}{text}{rest}")
    return file


def command(verb, file, *options):
    done = subprocess.run([knap.program(), verb, file, *options], capture_output=True, text=True, cwd=folder)
    return done.returncode, done.stdout + done.stderr


def rectangle(size, edge, keys=""):
    return f"[domain]\nshape = 'rectangle'\nsize = {size}\n{keys}[mesh]\nsize = {edge}\n"


class Recipes(unittest.TestCase):
    def does(self, verb, file, *options):
        code, text = command(verb, file, *options)
        self.assertEqual(code, 0, text)
        return text

    def test_traces_of_a_map(self):
        x = 2600e3 + np.array([5, 40, 10, 30, 90, 120])
        y = 1200e3 + np.array([5, 25, 30, 10, 20, 35])
        kinds = ("fault", "fault", "joint")
        (folder / "map.csv").write_text("trace, x [m], y [m], class\n" + "".join(f"{i // 2}, {x[i]}, {y[i]}, {kinds[i // 2]}\n" for i in range(6)))
        text = recipe("origin    = [") + "[[traces]]\nfile = 'map.csv'\nclass = 'joint'\norigin = ['2600 km', '1200 km']\ncrop = true\n"
        file = scene("traces", text, rectangle("[100, 40]", "2") + minerals, "[interface.fault]\nsigma_c = 0\nfriction = 0.5\n\n[time]\nend = '1 ms'")
        said = self.does("check", file)
        self.assertIn("traces[0]      2 placed, ", said)
        for ending in ("svg", "msh"):
            self.does("mesh", file, "-o", folder / f"map.{ending}")
        self.assertTrue(">fault<" in (folder / "map.svg").read_text())
        self.does("run", file, "-o", folder / "traces", "-q")
        import knap_traces
        with contextlib.redirect_stdout(io.StringIO()) as out:
            sys.argv = ["knap-traces", str(folder / "map.msh"), "--scanline", "0", "15", "50", "15"]
            knap_traces.command()
        self.assertIn("P21", out.getvalue())

    def test_stress_over_depth_and_points(self):
        points = [(a, b) for a in (0, 1) for b in (98, 100)]
        (folder / "residual.csv").write_text("x [mm], y [mm], xx [MPa], yy [MPa], xy [MPa]\n" + "".join(f"{1e3 * a}, {1e3 * b}, -0.01, -0.01, 0\n" for a, b in points))
        (folder / "profile.csv").write_text("t [h], x [m], y [m], p [MPa]\n0, 60, 0, 1.35\n0, 60, 100, 0\n1, 60, 0, 1.35\n1, 60, 100, 0\n")
        text = recipe('stress = "residual.csv"')
        file = scene("stress", text, rectangle("['60 m', '100 m']", "4", "") + minerals.replace("mica", "rock"),
                     "[[load]]\nname = 'below'\non = 'bottom'\ndisplacement = ['free', 0]\n\n[time]\nend = '1 ms'")
        self.assertIn("initial stress up to 2.", self.does("check", file, "-s", "initial[1].box=['0 m', '90 m', '4 m', '100 m']",
                                                           "-s", "initial[1].stress=[0, 0, 0]"))
        file.write_text(file.read_text().replace("size = 4", "size = 4\nrefine = [{ inside = [0, 97, 2, 100], size = 0.5 }]"))
        self.does("run", file, "-o", folder / "stress", "-q")
        self.assertEqual(knap.read(folder / "stress").summary["broken_length"], 0)

    def test_a_pump_drives_a_crack(self):
        body = ("[domain]\nshape = 'rectangle'\nsize = [0.4, 0.4]\ncrack = [{ points = [[0, 0.2], [0.02, 0.2]] }]\n[mesh]\nsize = 0.02\n"
                "refine = [{ along = [[0, 0.2], [0.1, 0.2]], width = 0.01, size = 0.002 }]\n" + minerals)
        more = "[[load]]\non = 'right'\ndisplacement = [0, 0]\n\n[time]\nend = '2 ms'\nstep = '25 us'\n\n[output]\nfields = false"
        file = scene("pump", recipe("# the pump stops"), body, more)
        self.does("run", file, "-o", folder / "pump", "-q")
        run = knap.read(folder / "pump")
        fluids = run.table("fluids")
        np.testing.assert_allclose(fluids["water_injected"], 8.75e-5 * np.minimum(fluids["time"], 10e-3), atol=1e-15)
        wet = fluids["water_pressure"] > 0  # elsewhere the crack has more room
        self.assertGreater(wet.sum(), 50)
        np.testing.assert_allclose((fluids["water_volume"] + 1e-15 * fluids["water_pressure"])[wet], fluids["water_injected"][wet], rtol=5e-3)  # with edges that break in this step
        self.assertGreater(fluids["water_sharp_crack"][-1], 0.02)

    def test_grains_of_a_picture(self):
        colour = np.where((np.arange(80)[None, :] // 10 + np.arange(40)[:, None] // 10) % 2, 0xd0, 0x20).astype(np.uint8)
        rows = b"".join(b"\0" + bytes(np.repeat(row, 3)) for row in colour)
        parts = ((b"IHDR", struct.pack(">IIBBBBB", 80, 40, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
        (folder / "thin_section.png").write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts))
        file = scene("picture", recipe("# each patch of one colour is a grain"), rectangle("[0.02, 0.01]", "0.0005") + minerals, "[time]\nend = '1 us'")
        self.assertRegex(self.does("check", file), "16 of quartz .*, 16 of mica ")
        self.does("run", file, "-o", folder / "picture", "-q")

    def test_a_mesh_of_others(self):
        # four surfaces without names of materials, each two triangles beside each other along x, 25 mm x 50 mm
        points = [(x, y) for y in (0, 50) for x in (0, 25, 50, 75, 100)]
        triangles = [t for i in range(4) for t in ((i, i + 1, i + 6, i + 1), (i, i + 6, i + 5, i + 1))]
        points += [(47.5, 49), (52.5, 49)]
        (folder / "polycrystal.msh").write_text(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n" + "".join(f"{i + 1} {x} {y} 0\n" for i, (x, y) in enumerate(points[:10])) +
            "$EndNodes\n$Elements\n8\n" + "".join(f"{i + 1} 2 2 {g} {g} {a + 1} {b + 1} {c + 1}\n" for i, (a, b, c, g) in enumerate(triangles)) + "$EndElements\n")
        text = recipe("# of all surfaces without the name of a material").replace('box      = ["45 mm", "48 mm"', 'box      = ["30 mm", "30 mm"')
        rock = minerals.replace("quartz", "rock").replace("mica", "steel")
        file = scene("crystal", text, rock, "[time]\nend = '1 us'")
        said = self.does("check", file)
        self.assertIn("mesh.material  rock: of 4 surfaces that are no material", said)
        self.assertIn("of rock", said)
        self.does("run", file, "-o", folder / "crystal", "-q")

    def test_events_of_a_run(self):
        lines = recipe("knap-events runs/crushed").splitlines()
        done = subprocess.run([knap.program(), *lines[0].split()[1:], "-q", "-s", "mesh.size=1.5 mm", "-s", "figure=[]"], cwd=folder, capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 4), done.stdout + done.stderr)
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("python3-matplotlib is not installed")
        done = subprocess.run([sys.executable, tools / "knap-events", *lines[1].split()[1:]], cwd=folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(" events of ", done.stdout)
        found, rates = knap.read_csv(folder / "events.csv"), knap.read_csv(folder / "rate.csv")
        self.assertEqual(rates["events"].sum(), len(found["time"]))
        self.assertEqual(list(rates), ["axial_strain", "events", "rate", "energy"])

    def test_a_factor_of_safety(self):
        body = rectangle("[1, 0.2]", "0.1") + "[material.rock]\ndensity = 2000\nE = 1e10\nnu = 0.2\n"
        more = ("[interface.default]\nsigma_c = 1421.7142857142858\ndelta_c = 0.02\ngamma = 1\nfriction = 0.4\n\n[[support]]\non = 'bottom'\ninterface = 'default'\n"
                "glued = true\n\n[interface.rock-rock]\nbreakable = false\n\n[[load]]\nacceleration = [8, -10]")
        text = recipe("# what moved further does not stand").replace('"10 s"', '"0.1 s"').replace("[1, 3]", "[1, 1.5]")
        file = scene("slope", text, body, more)
        said = self.does("study", file, "--safety", "-j", "2", "-o", folder / "safety", "-q")
        factor = float(said.split("factor of safety ")[1].split(":")[0])
        self.assertLess(abs(factor / 1.122 - 1), 0.01)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
