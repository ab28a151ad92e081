"""What the site is made of beside its pages: gallery from the examples, changelog, packages for the API pages."""

import ast
import json
import os
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files, InclusionLevel

ROOT = Path(__file__).parents[2]
PACKAGES = ("core", "models", "viewer", "fmu_wrapper", "validation", "cli")
WIDE = "---\nhide: [toc]\n---\n"
"""Head of pages whose lines of code are long: without the list of headings beside them."""
LANGUAGES = {".toml": "toml", ".c": "c", ".py": "python"}


def _as_package() -> None:
    """The folders as the package that they are installed as, for mkdocstrings, which reads files."""
    home = ROOT / "build" / "docs" / "tlismni"
    home.mkdir(parents=True, exist_ok=True)
    (home / "__init__.py").touch()
    for name in PACKAGES:
        if not (home / name).exists():
            try:
                os.symlink(ROOT / name, home / name, target_is_directory=True)
            except OSError:  # Windows without the right to make links
                import shutil

                shutil.copytree(ROOT / name, home / name)


_as_package()  # now: when hooks are called, mkdocstrings has looked which folders there are


def on_files(files: Files, config: Any) -> Files:
    """A page for every example, one that shows them all, and the changelog."""
    examples = sorted((ROOT / "examples").glob("*.py"))
    for path in examples:
        page = File.generated(config, f"gallery/{path.stem}.md", content=example_page(path))
        page.inclusion = InclusionLevel.NOT_IN_NAV
        files.append(page)
    files.append(File.generated(config, "gallery/index.md", content=gallery_page(examples)))
    for path in sorted((ROOT / "docs" / "notebooks").glob("*.ipynb")):
        page = File.generated(config, f"notebooks/{path.stem}.md", content=notebook_page(path))
        page.inclusion = InclusionLevel.NOT_IN_NAV
        files.append(page)
    files.append(File.generated(config, "changelog.md", content=(ROOT / "CHANGELOG.md").read_text(encoding="utf-8")))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:
    """Links to examples lead to their pages in the gallery."""
    depth = "../" * page.file.src_uri.count("/")

    def linked(match: re.Match[str]) -> str:
        stem = Path(match[1]).stem
        return f"]({depth}gallery/{stem if stem != 'control' else 'embedding'}.md)"

    text = re.sub(r"\]\((?:\.\./)+examples/([^)#]+)\)", linked, markdown)
    return text.replace("gallery/embedding.md", "embedding.md").replace("](../docs/", "](").replace("](docs/", "](")


def on_page_content(html: str, page: Any, config: Any, files: Any) -> str:
    """Pictures open at full size, and columns of words are wider than those of numbers."""
    text = re.sub(r"(?<!>)(<img [^>]*src=\"([^\"]+)\"[^>]*>)(?!</a>)", r'<a class="picture" href="\2">\1</a>', html)
    return re.sub(r"<table>.*?</table>", lambda table: with_widths(table[0]), text, flags=re.S)


def with_widths(table: str) -> str:
    """The table with a class for the cells of each column: it holds "sentences", some "words", or what is "short"."""
    rows = [re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row, re.S) for row in re.findall(r"<tr>.*?</tr>", table, re.S)]
    lengths = [max(len(re.sub(r"<[^>]+>", "", row[k])) for row in rows if k < len(row)) for k in range(len(rows[0]))]
    kinds = ["sentences" if length > 70 else "words" if length > 25 else "short" for length in lengths]

    def classed(row: re.Match[str]) -> str:
        left = iter(kinds)
        return re.sub(
            r"<(t[dh])", lambda cell: f'<{cell[1]} class="{kind}"' if (kind := next(left)) else cell[0], row[0]
        )

    return re.sub(r"<tr>.*?</tr>", classed, table, flags=re.S)


def notebook_page(path: Path) -> str:
    """The cells of a notebook; the notebook itself lies beside the page."""
    parts = [WIDE]
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        text = "".join(cell["source"])
        parts += [text, ""] if cell["cell_type"] == "markdown" else ["```python", text, "```", ""]
    return "\n".join([*parts, f"[The notebook itself]({path.name})", ""])


def title_of(path: Path) -> str:
    """A file's name as a heading."""
    return path.stem.replace("_", " ").capitalize()


def words_of(path: Path) -> str:
    """The docstring of an example."""
    return ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""


def picture_of(stem: str) -> str:
    """Its picture, seen from the folder of the gallery; empty without."""
    found = (f"{stem}.gif", f"{stem}.png", f"../images/{stem}.png")
    return next((name for name in found if (ROOT / "docs" / "gallery" / name).is_file()), "")


def example_page(path: Path) -> str:
    """Words, moving picture and source of an example."""
    picture = picture_of(path.stem)
    parts = [WIDE, f"# {title_of(path)}", "", words_of(path), ""]
    if picture:
        parts += [f"![{title_of(path)}]({picture})", ""]
    parts += [f"Run it: `python examples/{path.name}`", ""]
    for file in sorted((ROOT / "examples").glob(f"{path.stem}.*"), reverse=True):
        if file.suffix in LANGUAGES:
            name, text = file.name, file.read_text(encoding="utf-8")
            parts += [f'```{LANGUAGES[file.suffix]} title="examples/{name}"', text.rstrip(), "```", ""]
    return "\n".join(parts)


def gallery_page(examples: list[Path]) -> str:
    """A card for every example."""
    parts = [
        WIDE,
        "# Gallery",
        "",
        "Each one is a script, a test and a page. The pictures are made by the scripts.",
        "",
    ]
    parts += ['<div class="grid cards" markdown>', ""]
    for path in sorted(examples, key=lambda p: not picture_of(p.stem).endswith(".gif")):
        picture, first = picture_of(path.stem), words_of(path).split("\n\n")[0].replace("\n", " ")
        parts += [f"-   **[{title_of(path)}]({path.stem}.md)**", ""]
        parts += [f"    [![{title_of(path)}]({picture})]({path.stem}.md)", ""] if picture else []
        parts += [f"    {first}", ""]
    return "\n".join([*parts, "</div>", ""])
