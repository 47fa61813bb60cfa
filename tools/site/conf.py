"""Settings of Sphinx for the site of the documentation (tools/site/build). The pages are those of the repository as they are; what Sphinx reads
of them is changed here where GitHub's Markdown has more: anchors written as HTML, links to folders."""
import html
import pathlib
import re

project = "knap"
extensions = ["myst_parser"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # a page may skip a level
exclude_patterns = ["_build"]
root_doc = "README"
html_theme = "alabaster"
html_theme_options = {"description": "2D dynamic fracture", "page_width": "75em", "sidebar_width": "16em", "font_family": "system-ui, sans-serif"}
html_css_files, html_js_files = ["narrow.css"], ["found.js"]
html_static_path = html_css_files + html_js_files
templates_path = ["templates"]
html_sidebars = {"**": ["about.html", "searchbox.html", "navigation.html"]}
html_show_sphinx = html_show_copyright = html_show_sourcelink = html_copy_source = False
link = re.compile(r"\[((?:`[^`\n]*`|[^\]`])*)\]\(([^)\s]*)\)")


def words(text):
    """Of a link, as HTML."""
    return re.sub(r"`([^`]*)`", r"<code>\1</code>", html.escape(text, quote=False))


def read(app, page, source):
    here = pathlib.Path(app.srcdir, page).parent

    def as_html(match):
        text, (target, _, anchor) = match[1], match[2].partition("#")
        if "://" in target or match.string[match.start() - 1:match.start()] == "!": return match[0]
        file = here / target if target else pathlib.Path(app.srcdir, page + ".md")
        if file.is_dir() or not file.exists(): return text if file.is_dir() else match[0]
        marked = anchor and f'<a id="{anchor}">' in (file.read_text(encoding="utf-8") if file.suffix == ".md" else "")
        return f'<a href="{target[:-3] + ".html" if target else ""}#{anchor}">{words(text)}</a>' if marked else match[0]

    parts = re.split(r"((?:^    .*\n?)+)", source[0], flags=re.MULTILINE)  # code stays
    source[0] = "".join(part if i % 2 else link.sub(as_html, part) for i, part in enumerate(parts))


def setup(app):
    app.connect("source-read", read)
