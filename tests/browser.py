"""report.html of a run, a study and a sweep in headless Chromium: `browser.py KNAP DIRECTORY`. At the widths of a phone, a tablet, a screen and
on A4 nothing is wider than the page, and no number is broken, on A4 no name but behind an underscore; text stands off from the page in light and in dark mode; a live page is there
before the mesh is, loads itself, and says when its run was killed.
`browser.py --site SITE DIRECTORY`: no page of the site (tools/site/build) is wider than a phone, which may zoom, or than a screen; wide tables
scroll; the search is above the page and leads to the words. Exit code 77: no Chromium, or no site."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import time

chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
if not chromium:
    print("skipped: there is no chromium (Debian: chromium)")
    sys.exit(77)
knap, folder = sys.argv[-2], pathlib.Path(sys.argv[-1])
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)


def browse(page, *options):
    """What the browser prints. File pages may look into frames of each other; as root it has no sandbox."""
    return subprocess.run([chromium, "--headless=new", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files",
                           f"--user-data-dir={folder}/profile", *options, page.as_uri()],
                          check=True, capture_output=True, text=True, timeout=300).stdout


def measured(page, width, dark):
    """Of a page in a frame of this width: width of its content, columns of its figures, contrast of its text, texts of pictures."""
    harness = folder / "harness.html"
    harness.write_text(f"""<iframe id="f" style="width:{width}px;height:800px;border:0" src="{page.as_uri()}"></iframe><pre id="out"></pre><script>
const light = text => {{ const [r, g, b] = text.match(/[0-9.]+/g).map(x => (x /= 255) <= 0.03928 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
                         return 0.2126 * r + 0.7152 * g + 0.0722 * b; }};
const moved = box => {{  // what the first picture of the slider is called, beside it and for who does not see it
  if (!box) return [];
  const line = box.querySelector("input");
  line.value = 0, line.oninput();
  return [box.querySelector("img").alt, box.querySelector("figcaption").textContent]; }};
const contrast = (a, b) => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
document.getElementById("f").onload = () => {{
  const d = document.getElementById("f").contentDocument, of = e => d.defaultView.getComputedStyle(e), paper = light(of(d.body).backgroundColor);
  const texts = [...d.querySelectorAll("body, figcaption, .bad, pre, td")].map(e => contrast(light(of(e).color), paper));
  const figures = d.querySelector(".figures"), parts = e => {{ const all = d.createRange(); all.selectNodeContents(e); return all.getClientRects().length; }};
  const lines = cell => {{  // of its text
    const found = [], at = d.createRange(), texts = d.createTreeWalker(cell, NodeFilter.SHOW_TEXT);
    for (let bottom, n; (n = texts.nextNode());)
      for (let i = 0; i < n.length; ++i) {{
        at.setStart(n, i), at.setEnd(n, i + 1);
        const box = at.getClientRects()[0];
        if (!box) continue;
        if (!(Math.abs(box.bottom - bottom) < 4)) found.push("");
        bottom = box.bottom, found[found.length - 1] += n.data[i];
      }}
    return found; }};
  const split = [...d.querySelectorAll("th, td")].map(lines).filter(l => l.some((line, i) => /[a-z0-9]$/.test(line) && /^\\w/.test(l[i + 1] || "")));
  const numbers = [...d.querySelectorAll("td")].filter(e => /^[-+.]?[0-9]\\S*$/.test(e.textContent));
  document.getElementById("out").textContent = "MEASURED " + JSON.stringify({{ width: d.documentElement.scrollWidth,
    columns: figures ? of(figures).gridTemplateColumns.split(" ").length : 0, contrast: Math.min(...texts), dark: paper < 0.5,
    texts: [...d.images].map(i => i.alt), numbers: numbers.length, broken: numbers.filter(e => parts(e) > 1).map(e => e.textContent), split: split.map(l => l.join("|")), cut: [...d.querySelectorAll(".table")].filter(t => t.scrollWidth > t.clientWidth).map(t => t.textContent.slice(0, 60)), moved: moved(d.getElementById("frames")) }});
}};</script>""")
    found = re.search(r"MEASURED (\{.*?\})<", browse(harness, "--window-size=1400,900", f"--blink-settings=preferredColorScheme={0 if dark else 1}",
                                                    "--virtual-time-budget=20000", "--dump-dom"), re.DOTALL)
    assert found, "the page was not measured"
    return json.loads(found[1].replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">"))


def check_site(site, width):
    """All pages, one after the other in a frame of this width: no sideways scroll but of what is too wide itself. Then a search."""
    pages = [page.as_uri() for page in sorted(site.rglob("*.html"))]
    harness = folder / "harness.html"
    harness.write_text(f"""<iframe id="f" style="width:{width}px;height:800px;border:0"></iframe><pre id="out"></pre><script>
(async () => {{
  const frame = document.getElementById("f"), found = [], open = page => new Promise(resolve => {{ frame.onload = resolve, frame.src = page; }});
  const wait = async what => {{ for (let i = 0; i < 200 && !what(); ++i) await new Promise(resolve => setTimeout(resolve, 50)); return what(); }};
  for (const page of {json.dumps(pages)}) {{
    await open(page);
    const d = frame.contentDocument, top = e => e.getBoundingClientRect().top, search = d.getElementById("searchbox");
    found.push([page, d.documentElement.scrollWidth, d.documentElement.clientWidth, [...d.querySelectorAll("table")].filter(t => t.scrollWidth > t.clientWidth).length,
                [...d.querySelectorAll("meta[name=viewport]")].map(m => m.content), !search || top(search) < top(d.querySelector("div.body"))]);
  }}
  await open({json.dumps((site / "search.html").as_uri() + "?q=thaws")});
  const hit = await wait(() => frame.contentDocument.querySelector("#search-results li a"));
  await open(hit.href);
  const inView = () => {{
    const word = frame.contentDocument.querySelector("span.highlighted"), box = word && word.getBoundingClientRect();
    return box && frame.contentWindow.scrollY > 0 && box.top > 0 && box.bottom < 800 ? word.textContent : "";
  }};
  found.push(await wait(inView));
  document.getElementById("out").textContent = "MEASURED " + JSON.stringify(found);
}})();</script>""")
    found = re.search(r"MEASURED (\[.*?\])<", browse(harness, "--window-size=1400,900", "--virtual-time-budget=120000", "--dump-dom"), re.DOTALL)
    assert found, "the site was not measured"
    *measured, word = json.loads(found[1])
    assert len(measured) == len(pages) > 20, len(measured)
    wide = [(page, needed) for page, needed, room, *_ in measured if needed > room]  # beside the bar that scrolls
    assert not wide, wide
    assert all(viewports in ([], ["width=device-width, initial-scale=1.0"]) for *_, viewports, _ in measured), measured  # index.html: none
    assert width > 400 or all(search_is_first for *_, search_is_first in measured), measured  # a screen has it beside the page
    assert word.lower().startswith("thaw"), word  # which is far below the top of its page
    n_scrolling = sum(n for _, _, _, n, *_ in measured)
    assert n_scrolling > 10 or width > 400, n_scrolling  # keys and outputs have wide tables
    print(f"{len(pages)} pages fit {width} px, where {n_scrolling} tables scroll by themselves")


if sys.argv[1] == "--site":
    if not (site := pathlib.Path(knap)).is_dir():
        print(f"skipped: there is no site in {site}")
        sys.exit(77)
    for width in (375, 1000, 1280): check_site(site.resolve(), width)
    sys.exit()

environment = {**os.environ, "OMP_NUM_THREADS": "1"}
subprocess.run([knap, "run", "edge_cracked_block", "-q", "-s", "mesh.size=2 mm", "-s", "expect={dissipated={below=0}}", "-o", folder / "run"],
               env=environment, stdout=subprocess.DEVNULL)
report = folder / "run/report.html"
for width, columns in ((320, 1), (360, 1), (375, 1), (768, 2), (1280, 2)):
    for dark in (False, True):
        page = measured(report, width, dark)
        print(width, "dark" if dark else "light", {name: page[name] for name in ("width", "columns", "contrast")})
        assert page["width"] <= width, page
        assert page["columns"] == columns, page
        assert not page["cut"], page["cut"]  # tables of numbers and meanings
        assert page["numbers"] > 20 and not page["broken"], page["broken"]
        assert page["dark"] == dark, page
        assert page["contrast"] >= 4.5, page  # WCAG 2.1, AA
        assert all(len(text.split()) >= 3 for text in page["texts"]), page["texts"]
        assert page["moved"][0] == page["moved"][1] and page["moved"][0].endswith("t = 0 s") and " " in page["moved"][0][:-9], page["moved"]



def on_paper(report):
    """A copy that a screen shows as A4 paper does."""
    copy = folder / "paper.html"
    copy.write_text(report.read_text().replace("@media screen", "@media speech").replace("@media print", "@media all"))
    return copy


plate = ["edge_cracked_block", "-s", "expect={}"]
quantities = ["broken_length", "energy_residual", "dissipated", "fragments", "cohesive_friction_work", "max_tip_speed"]
for kind, command in (("study", ["study", "bar_ramp_wave"]), ("sweep", ["sweep", *plate, "-s", "time.end=30 us", "-s", "mesh.size=2 mm,3 mm", "--seeds", "1..2",
                                                                             "-s", f"sweep.quantities={json.dumps(quantities)}"])):
    subprocess.run([knap, *command, "-q", "-o", folder / kind], env=environment, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for width in (320, 375, 768, 1280):
        page = measured(folder / kind / "report.html", width, False)
        print(kind, width, {name: page[name] for name in ("width", "numbers", "cut")})
        assert page["width"] <= width and page["numbers"] >= 4 and not page["broken"], page  # wide tables scroll by themselves
        assert page["cut"] or width > 400, page
paper_width = round(180 / 25.4 * 96)  # [px] of 210 mm with margins of 15 mm
for kind in ("run", "study", "sweep"):
    page = measured(on_paper(folder / kind / "report.html"), paper_width, False)
    print(kind, "on A4", {name: page[name] for name in ("width", "numbers")})
    assert page["width"] <= paper_width and not page["cut"] and not page["broken"], page
    assert not page["split"], page["split"]  # names break behind underscores only

browse(report, f"--print-to-pdf={folder}/report.pdf", "--no-pdf-header-footer")
pdf = (folder / "report.pdf").read_bytes()
sides = re.search(rb"/MediaBox \[0 0 ([0-9.]+) ([0-9.]+)\]", pdf)
assert sides and abs(float(sides[1]) - 595.3) < 1.5 and abs(float(sides[2]) - 841.9) < 1.5, sides  # [pt] A4
print("paper", sides[1].decode(), "x", sides[2].decode(), "pt")

def start_live():
    return subprocess.Popen([knap, "run", "edge_cracked_block", "-s", "mesh.size=0.3 mm", "-s", "output.checkpoint_every=1 h", "-s", "figure=[]", "-s", "expect={}", "-o", folder / "live"],
                            env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


page = folder / "live/report.html"
live = start_live()
try:
    while not page.exists() and live.poll() is None: time.sleep(0.1)
    text = page.read_text()  # before the first step: no picture
    assert 'id="live"' in text and "makes its mesh" in text and "<img" not in text, text[:3000]
    while "<img" not in text and live.poll() is None: time.sleep(0.1), (text := page.read_text())
    live.kill(), live.wait()
    live = start_live()  # again from its start: an open page loads itself, so there must be one at any moment
    started, earlier = time.time(), text
    while (text == earlier or "<img" not in text) and live.poll() is None: time.sleep(0.005), (text := page.read_text())
    print(f"a page at any moment of a second start, the first picture after {time.time() - started:.1f} s")
    page = folder / "live.html"  # as it was at this moment
    page.write_text(text)
    assert 'id="live"' in text and "location.reload()" in text, "no live page"
    assert "This run goes on" in browse(page, "--dump-dom")
    assert "-s &#39;mesh.size=0.3 mm&#39;" in text, "what changed the scenario"
    assert measured(page, 375, True)["width"] <= 375
    harness = folder / "harness.html"  # opens the text of the scenario; the next load is by the page itself
    harness.write_text(f"""<iframe id="f" src="{page.as_uri()}"></iframe><pre id="out"></pre><script>
const frame = document.getElementById("f"), found = [];
frame.onload = () => {{
  const text = frame.contentDocument.querySelector("details");
  found.push(text.open), text.open = true;
  document.getElementById("out").textContent = "FOUND " + found.join();
}};</script>""")
    assert "FOUND false,true" in browse(harness, "--virtual-time-budget=20000", "--dump-dom"), "what was opened is closed again"
    live.kill()
    live = subprocess.Popen([knap, "sweep", *plate, "-s", "mesh.size=3 mm,0.4 mm", "--seeds", "1..2", "-o", folder / "live_sweep"], env=environment,
                            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    page, sweep, so_far = folder / "live_sweep/report.html", "", r"2 of 4 runs are done, 0 failed, 2 to go, about \d+ (s|min) left; now size_0.4_mm_s1"
    while not re.search(so_far, sweep) and live.poll() is None: time.sleep(0.1), (sweep := page.read_text() if page.exists() else "")
    assert re.search(so_far, sweep) and 'value="0.500"' in sweep and "2 of 2" in sweep and "This sweep goes on" in browse(page, "--dump-dom"), sweep[-3000:]
finally:
    live.kill()
page = folder / "live.html"
assert "Written at 20" in text  # for who has no scripts
page.write_text(re.sub(r'data-written="\d+"', f'data-written="{int(time.time()) - 3600}"', text))
late = browse(page, "--dump-dom")
assert "This run goes on" not in late.replace("This run goes on: \"", "") and "has ended before its end" in late and "60 min" in late and "starts it again" in late, late[-3000:]
print("live page read, and that of a run that was killed an hour ago")
