"""Every page of a report as pictures, in both widths and themes, and what each measures; ``make pages`` runs it.

Usage: python -m tests.pages.show [REPORT [PICTURES]]
"""

from __future__ import annotations

import sys
from pathlib import Path

from tests.pages.browser import HEIGHT, THEMES, WIDTHS, executable, opened, pages, started

HEAD = ("page", "screens", "nodes", "kB", "paint ms", "sheets", "faults", "axe")
TALLEST = 16_000  # px of one picture: taller pages go on in the next


def main(words: list[str]) -> int:
    """Take the pictures, print the table; 1 where a page has a fault."""
    folder = Path(words[0] if words else "build/report")
    target = Path(words[1]) if len(words) > 1 else folder.parent / "pages"
    if executable() is None:
        print("no Chromium on this machine: install it to see the pages")
        return 2
    target.mkdir(parents=True, exist_ok=True)
    print("  ".join(HEAD))
    bad = 0
    with started() as found:
        for page in pages(folder):
            with opened(found, page) as look:
                facts, empty, grave = look.facts(), look.empty(), look.grave()
                row = (
                    str(page.relative_to(folder)), f"{facts['screens']:.1f}", str(facts["nodes"]),
                    f"{look.bytes_loaded / 1e3:.0f}", f"{look.paint():.0f}", str(look.sheets()),
                    str(len(look.faults) + len(empty)), str(len(grave)),
                )  # fmt: skip
                print("  ".join(row), *look.faults, *empty, *grave, *facts["small"][:3], sep="\n    ")
                bad += len(look.faults) + len(empty) + len(grave)
            for width in WIDTHS:
                for theme in THEMES:
                    with opened(found, page, width, theme) as look:
                        look.empty()  # loads the pictures further down
                        height = round(look.facts()["screens"] * HEIGHT)
                        for number, top in enumerate(range(0, height, TALLEST)):
                            box = {"x": 0, "y": top, "width": width, "height": min(TALLEST, height - top)}
                            name = f"{page.stem}-{width}-{theme}{f'-{number + 1}' if number else ''}.png"
                            look.page.screenshot(path=target / name, clip=box, full_page=True)
    print(f"pictures: {target}")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
