"""JavaScript functions called from tests: by node where it is installed, else in Chromium."""

from __future__ import annotations

import json
import shutil
import subprocess

from tests.pages import browser


def called(source: str, arguments: object) -> object:
    """What a JavaScript function gives for arguments, both as JSON."""
    script = f"({source})({json.dumps(arguments)})"
    if shutil.which("node"):
        run = ["node", "-e", f"process.stdout.write(JSON.stringify({script}))"]
        return json.loads(subprocess.run(run, capture_output=True, check=True, text=True).stdout)
    browser.demand()
    with browser.started() as chromium:
        return chromium.new_page().evaluate(script)
