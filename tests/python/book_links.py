"""Follows every link and anchor of a folder of HTML pages.

    python book_links.py FOLDER

Addresses elsewhere are passed over: no network is asked.
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """A page's targets, and the places within it that have a name."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.places = [], {"", "top"}
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        known = dict(attributes)
        self.places.update(known[k] for k in ("id", "name") if known.get(k))
        targets = (known.get("href"), known.get("src"))
        self.targets += [target for target in targets if target]


def fault(folder, page, target, pages):
    """What is wrong with a link, if anything is."""
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return None
    file = (page.parent / unquote(parts.path)).resolve()
    file = page if not parts.path else file
    if not file.is_relative_to(folder) or not file.is_file():
        return "no file"
    places = pages[file].places if file in pages else {""}
    return None if unquote(parts.fragment) in places else "no place"


def main(folder):
    folder = folder.resolve()
    files = sorted(folder.rglob("*.html"))
    # The page of all pages repeats them; the one for what is not found is
    # written for the root of a server.
    files = [f for f in files if f.name not in ("print.html", "404.html")]
    pages = {file: Page(file.read_text(encoding="utf-8")) for file in files}
    followed, faults = 0, []
    for page, known in pages.items():
        for target in known.targets:
            followed += 1
            wrong = fault(folder, page, target, pages)
            if wrong:
                name = page.relative_to(folder)
                faults.append(f"{name}: {wrong} {target}")
    if faults or not followed:
        sys.exit("\n".join(faults) or f"no link in {folder}")
    print(f"{followed} links of {len(files)} pages lead somewhere")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
