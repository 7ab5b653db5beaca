"""Checks of the page itself (canopus/web/page): its tests without a browser, and those in a real Chromium on a run of the program."""
import os
import pathlib
import re
import shutil

from kit import (ROOT, Skip, browser, check, command, first_plant_file, page_files, page_tool, program, require, running, scratch, tier)
from web_checks import ask, page_of

PAGE = ROOT / "canopus/web/page"


@check
def page_tests():
    """Types, store and views, by node's own test runner."""
    done = page_tool("--test")
    require("fail 0" in done.stdout, done.stdout[-3000:])


@check
def page_files_lie_beside_the_program_or_in_its_installation():
    """Without them a sentence says how to get them; the run goes on. With them each is sent once as long as it stays the same."""
    bare = scratch / "bare"
    for folder in ("bin", "share/canopus"):
        (bare / folder).mkdir(parents=True, exist_ok=True)
    shutil.copy(program, bare / "bin/canopus")
    plant_file = first_plant_file()

    def answer(address, path, fields=""):
        port = int(address.split(":")[2].rstrip("/"))
        return ask(port, f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n{fields}\r\n")

    with running(plant_file, words=["--web"], copy=bare / "bin/canopus") as plant:
        address, _ = page_of(plant)
        require(answer(address, "/").startswith(b"HTTP/1.1 503 ") and b"tools/page build/page" in answer(address, "/"), answer(address, "/"))
        plant.wait(lambda e: e["event"] == "error" and e["source"] == "web" and "share/canopus/page" in e["message"])
        plant.wait_operational([1])
    shutil.copytree(page_files(), bare / "share/canopus/page")
    with running(plant_file, words=["--web"], copy=bare / "bin/canopus") as plant:
        address, _ = page_of(plant)
        require(b"<script" in answer(address, "/") and b"no-store" in answer(address, "/"), "the page")
        first = answer(address, "/page.js")
        head, _, body = first.partition(b"\r\n\r\n")
        require(head.startswith(b"HTTP/1.1 200 ") and body == (page_files() / "page.js").read_bytes(), head)
        tag = re.search(rb'ETag: ("[0-9a-f]{16}")', head)[1].decode()
        again = answer(address, "/page.js", f"If-None-Match: {tag}\r\n")
        require(again.startswith(b"HTTP/1.1 304 ") and again.endswith(b"\r\n\r\n"), again[:200])


def in_chromium(tests, *words, limit):
    """Those tests of canopus/web/page/test/browser.mjs whose names match, in `limit` seconds, on runs that it starts itself."""
    chromium = browser()
    page_files()
    pictures = pathlib.Path(os.environ.get("CANOPUS_PICTURES", scratch)) / "page"
    pictures.mkdir(parents=True, exist_ok=True)
    done = command("node", PAGE / "test/browser.mjs", "--program", pathlib.Path(program).resolve(), "--chromium", chromium, "--pictures", pictures,
                   "--only", tests, "--limit", limit, *words, timeout=limit + 60)
    require(re.search(r"^all [1-9]\d* good", done.stdout, re.MULTILINE), done.stdout[-3000:])


@check
@tier("browser")
def page_workflows_in_chromium():
    """What people do: clicks and characters counted, the keyboard alone, and what each screen can do."""
    in_chromium("^(?!screen |picture )", limit=800)


@check
@tier("browser")
def page_screens_in_chromium():
    """Every screen light and dark, at two sizes: nothing stands out of the window, axe-core finds nothing serious. Pictures are kept with CANOPUS_PICTURES."""
    in_chromium("^screen ", limit=800)


@check
@tier("browser")
def page_pictures_are_those_of_the_documentation():
    """Screens whose plant time stands still look as in docs/web, with the font of the pictures there."""
    font = command("fc-match", "-f", "%{family}", "sans-serif").stdout if shutil.which("fc-match") else "unknown"
    if font != "DejaVu Sans":
        raise Skip(f"the pictures are in DejaVu Sans, sans-serif is {font} here")
    in_chromium("^picture ", "--compare", ROOT / "docs/web", limit=600)
