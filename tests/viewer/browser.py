"""A page in a real browser without a screen."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PROBE = """<script>
(async () => {
  const found = {};
  try {
    %s
  } catch (error) { found.error = String(error); }
  const box = document.createElement("pre");
  box.id = "found";
  box.textContent = JSON.stringify(found);
  document.body.append(box);
})();
</script>"""
ERRORS = (
    "<script>window.failures = []; window.addEventListener('error', (e) => window.failures.push(e.message));</script>"
)

SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")


def browser() -> str:
    """The command of a browser; the test is skipped where there is none."""
    named = os.environ.get("BROWSER_FOR_TESTS")
    found = named or next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is on the PATH (Debian: apt-get install chromium)")
    return found


def probe(
    page: Path, script: str, size: tuple[int, int] = (1280, 800), flags: tuple[str, ...] = SOFTWARE
) -> dict[str, Any]:
    """Open `page` and run `script`, which puts what it finds into `found`; errors of the page are in found["failures"].

    The page is opened with its time stopped at the start (#t=0). `flags` say how the browser draws in space.
    """
    text = page.read_text(encoding="utf-8").replace("<head>", f"<head>{ERRORS}", 1)
    body = f"{script}\n    found.failures = window.failures;"
    probed = page.with_name(f"probed_{page.name}")
    probed.write_text(text.replace("</body>", f"{PROBE % body}</body>"), encoding="utf-8")
    done = subprocess.run(
        [
            browser(), "--headless", "--no-sandbox", *flags, "--disable-background-networking",
            f"--user-data-dir={page.parent / 'profile'}", f"--window-size={size[0]},{size[1]}",
            "--virtual-time-budget=6000", "--dump-dom", f"{probed.as_uri()}#t=0",
        ],
        capture_output=True, text=True, timeout=1200, check=False,
    )  # fmt: skip
    found = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, re.S)
    assert found, done.stderr[-2000:]
    return json.loads(found[1].replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&"))
