"""CITATION.cff, .zenodo.json and codemeta.json say the same of the same program: `metadata.py REPOSITORY`. With Debian's python3-yaml the keys
of CITATION.cff are those of the Citation File Format 1.2.0."""
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
works = [f"https://doi.org/{doi}" for doi in re.findall(r"doi: (\S+)", cff)] + re.findall(r"^    url: (\S+)", cff, re.MULTILINE)
assert sorted(works) == sorted(cited), works
seminar = re.search(r"\*([^*]+)\*, seminar", readme)[1].split()
assert " ".join(seminar) in cff, seminar  # the first work that the README names; it has no address

# https://github.com/citation-file-format/citation-file-format/blob/1.2.0/schema.json, what this file uses of it
general = {"cff-version", "message", "type", "title", "abstract", "version", "date-released", "license", "keywords", "authors",
           "preferred-citation", "references"}
of_work = {"type", "authors", "title", "journal", "volume", "year", "start", "doi", "url", "status", "institution", "notes"}
of_author = ({"name"}, {"family-names", "given-names"}, {"family-names", "given-names", "orcid"})
try:
    import yaml
    read = yaml.safe_load(cff)
    works = [read["preferred-citation"], *read["references"]]
    assert set(read) == general, set(read) ^ general
    assert (read["cff-version"], read["type"], read["preferred-citation"]["doi"]) == ("1.2.0", "software", "10.1016/j.cma.2022.115545")
    for work in works:
        assert {"type", "authors", "title"} <= set(work) <= of_work and work["type"] in ("article", "unpublished"), work
        assert work.get("status", "preprint") == "preprint" and isinstance(work.get("year", 2000), int), work
    for orcid in re.findall(r"orcid: (.*)$", cff, re.MULTILINE):  # ISO 7064, modulus 11-2
        digits = re.fullmatch(r'"https://orcid.org/(\d{4}-\d{4}-\d{4}-\d{3}[\dX])"', orcid)[1].replace("-", "")
        total = 0
        for digit in digits[:-1]: total = 2 * (total + int(digit))
        assert "0123456789X"[(12 - total % 11) % 11] == digits[-1], orcid
    for author in read["authors"] + [author for work in works for author in work["authors"]]: assert set(author) in of_author, author
except ImportError as missing:
    print(f"keys of CITATION.cff not read: {missing}")
print(f"version {version}, {len(cited)} works cited")
