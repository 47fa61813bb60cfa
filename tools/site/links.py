"""links.py DIRECTORY: the links of the HTML pages below a directory that lead nowhere in it, to a file or to an anchor, or that load something
from a network, a line each; exit code 1 where there is one."""
import html.parser
import pathlib
import sys
import urllib.parse

root = pathlib.Path(sys.argv[1]).resolve()


class Page(html.parser.HTMLParser):
    def __init__(self, file):
        super().__init__()
        self.links, self.loads, self.anchors = [], [], {""}
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[name] for name in ("id", "name") if values.get(name)}
        if tag == "a" and values.get("href"): self.links.append(values["href"])
        if tag in ("img", "script", "iframe") and values.get("src"): self.loads.append(values["src"])
        if tag == "link" and values.get("href"): self.loads.append(values["href"])


pages = {file: Page(file) for file in sorted(root.rglob("*.html"))}
dead, n = [], 0
for file, page in pages.items():
    dead += [f"{file.relative_to(root)}: loads {load}" for load in page.loads if "//" in load]
    for link in page.links + [load for load in page.loads if "//" not in load]:
        target, _, anchor = link.partition("#")
        if ":" in target.split("/")[0]: continue  # elsewhere, or data
        n += 1
        to = (file.parent / urllib.parse.unquote(target.split("?")[0])).resolve() if target else file
        if not to.is_file(): dead.append(f"{file.relative_to(root)}: {link}")
        elif to in pages and urllib.parse.unquote(anchor) not in pages[to].anchors: dead.append(f"{file.relative_to(root)}: {link}")
print("\n".join(dead) or f"{n} links of {len(pages)} pages lead somewhere")
sys.exit(bool(dead) or not pages)
