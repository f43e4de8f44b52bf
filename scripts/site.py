"""Hooks of MkDocs for mkdocs.yml.

Pages are written for reading in the repository. For the site, README, house tour and history join the
pages, links to them lead there, and links to other files outside of docs/ become their names.
"""

import os.path
import posixpath
import re

from mkdocs.structure.files import File

# The repository.
ROOT = posixpath.dirname(posixpath.dirname(os.path.abspath(__file__)))
# Files beside docs/ that are pages of the site.
JOINED = {"README.md": "about.md", "ARCHITECTURE.md": "architecture.md", "CHANGELOG.md": "changelog.md"}

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)#\s]*)(#[^)\s]*)?\)")
FENCE = re.compile(r"^\s*```")
LIST = re.compile(r"^(\s*)([-*]|\d+\.) ")


def on_files(files, config):
    for name, page in JOINED.items():
        files.append(File.generated(config, page, abs_src_path=f"{ROOT}/{name}"))
    return files


def relinked(text, page, files):
    """Links of a page, as the site has them."""
    outside = page in JOINED.values()
    folder = "" if outside else posixpath.join("docs", posixpath.dirname(page))
    here = posixpath.dirname(page)

    def one(match):
        image, label, target, anchor = match.groups()
        if not target or "://" in target or target.startswith("mailto:"):
            return match.group(0)
        path = posixpath.normpath(posixpath.join(folder, target))
        if path in JOINED:
            to = JOINED[path]
        elif path.startswith("docs/") and files.get_file_from_path(path[5:]):
            to = path[5:]
        elif path.startswith("docs/") and not posixpath.isdir(posixpath.join(ROOT, path)):
            # Leads nowhere: MkDocs says so.
            return match.group(0)
        else:
            # In the repository alone; a test of Pluvia looks whether it is there.
            return label if "`" in label else f"{label} (`{path}`)"
        return f"{image}[{label}]({posixpath.relpath(to, here or '.')}{anchor or ''})"

    return LINK.sub(one, text)


def on_page_markdown(markdown, page, config, files):
    """Lists as GitHub reads them: no empty line before, two or three spaces of indentation."""
    lines, fenced, marker, before = [], False, 0, ""
    prose = []

    def flush():
        # Links may go over the end of a line.
        lines.extend(relinked("\n".join(prose), page.file.src_uri, files).split("\n") if prose else [])
        prose.clear()

    for line in markdown.split("\n"):
        fence = FENCE.match(line)
        if not fenced and not fence:
            item = LIST.match(line)
            if item and not item.group(1):
                if before.strip() and not LIST.match(before) and not before.startswith(" "):
                    prose.append("")
                marker = len(item.group(0))
            elif line.strip() and not line.startswith(" "):
                marker = 0
        if marker and line.startswith(" "):
            line = "    " + line[min(marker, len(line) - len(line.lstrip())):]
        if fence:
            flush()
            fenced = not fenced
            lines.append(line)
        else:
            (lines if fenced else prose).append(line)
        before = line
    flush()
    return "\n".join(lines)
