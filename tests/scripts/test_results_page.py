"""scripts/results-page: tables stay tables, text stays text, a missing file is told."""
import html.parser
import pathlib
import subprocess

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.rows, self.pre, self.pictures, self.inside = [], "", [], None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.inside = tag
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
        if tag == "img":
            self.pictures.append(dict(attributes)["src"])

    def handle_endtag(self, tag):
        self.inside = None

    def handle_data(self, data):
        if self.inside in ("td", "th"):
            self.rows[-1][-1] += data
        elif self.inside == "pre":
            self.pre += data


def page(folder, *files):
    done = subprocess.run([ROOT / "scripts" / "results-page", "--title", "A & B", "--out", folder / "index.html",
                           "--made-by", "make it", *files], cwd=folder, capture_output=True, text=True, timeout=60)
    return done, (folder / "index.html").read_text() if (folder / "index.html").exists() else ""


def test_what_was_printed_is_on_the_page(tmp_path):
    (tmp_path / "a.md").write_text("first < line\n\n| fault | n |\n|---|--:|\n| a > b | 3 |\n\nlast line\n")
    (tmp_path / "b.csv").write_text("x,y\n1,2\n")
    (tmp_path / "c.txt").write_text("  kept   as it is\n")
    (tmp_path / "d.png").write_bytes(b"")
    done, text = page(tmp_path, "a.md", "b.csv", "c.txt", tmp_path / "d.png")
    assert done.returncode == 0, done.stderr
    seen = Page(text)
    assert seen.rows == [["fault", "n"], ["a > b", "3"], ["x", "y"], ["1", "2"]]
    assert "first < line" in seen.pre and "last line" in seen.pre and "  kept   as it is" in seen.pre
    assert seen.pictures == ["d.png"]
    assert "<title>A &amp; B</title>" in text and "make it" in text


@pytest.mark.parametrize("name,content", [("none.md", None), ("none.png", None), ("a.pdf", b"x"), ("b.txt", b"\xff\xfe"),
                                          ("c.csv", b"")])
def test_what_cannot_be_shown_is_told(name, content, tmp_path):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    done, text = page(tmp_path, name)
    assert done.returncode == 2 and name in done.stderr and "Traceback" not in done.stderr
    assert text == ""
