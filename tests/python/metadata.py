"""CITATION.cff, .zenodo.json and codemeta.json say the same of the same program: `metadata.py REPOSITORY`."""
import json
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
cff = (root / "CITATION.cff").read_text(encoding="utf-8")
zenodo, codemeta = (json.loads((root / name).read_text(encoding="utf-8")) for name in (".zenodo.json", "codemeta.json"))
readme = (root / "README.md").read_text(encoding="utf-8")


def of_cff(key):
    return re.search(rf"^{key}: (.*)$", cff, re.MULTILINE)[1].strip('"')


version = re.search(r"project\(knap VERSION ([0-9.]+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
assert {of_cff("version"), zenodo["version"], codemeta["version"]} == {version}, version
assert of_cff("date-released") == zenodo["publication_date"] == codemeta["datePublished"]
assert of_cff("title") == zenodo["title"]
assert of_cff("license") == zenodo["license"] == codemeta["license"].rsplit("/", 1)[1] == "GPL-3.0-or-later"
keywords = re.findall(r"^  - (.+)$", cff[cff.index("keywords:"):cff.index("\nauthors:")], re.MULTILINE)
assert keywords == zenodo["keywords"] == codemeta["keywords"] and len(keywords) > 5
abstract = " ".join(cff[cff.index("abstract: >-") + 12:cff.index("\nversion:")].split())
assert abstract == zenodo["description"] == codemeta["description"]
cited = codemeta["referencePublication"] + codemeta["citation"]
for url, related in zip(cited, zenodo["related_identifiers"], strict=True):
    assert url.rsplit("/", 1)[1] in related["identifier"], url
    assert url in readme, url
for doi in re.findall(r"doi: (\S+)", cff): assert f"https://doi.org/{doi}" in cited, doi
print(f"version {version}, {len(cited)} works cited")
