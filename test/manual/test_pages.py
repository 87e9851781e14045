# SPDX-License-Identifier: BSD-3-Clause
"""The pages of the manual are true: what they show runs as shown, and the reference is complete.

A page's code is one of four kinds, and any other fails:
  ```console          commands ($) with their output, run in a shell; "..." stands for any text
  ```pycon            a Python session (>>>) with its output, by the same rule
  ```{literalinclude} a file that other tests compile or run
  :class: elsewhere   what this machine cannot run (ROS, apt); the page says what it needs
A page's commands and sessions run in their order, in one folder that has the repository's `data`."""
import doctest
import os
import pathlib
import re
import subprocess

import pytest

import fcl_artic

ROOT = pathlib.Path(__file__).resolve().parents[2]
MANUAL = ROOT / "doc" / "manual"
PAGES = sorted(MANUAL.rglob("*.md"))
FENCE = re.compile(r"^(`{3,})([^\n]*)\n(.*?)^\1$", re.M | re.S)
RUN_BY_OTHER_TESTS = [MANUAL / "snippets", ROOT / "example", ROOT / "python" / "example", ROOT / "test" / "consumer"]
CHECKER = doctest.OutputChecker()
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def blocks(page):
    """(line, kind, text) of the page's fenced blocks."""
    text = page.read_text()
    return [(text.count("\n", 0, block.start()) + 1, block[2].strip(), block[3]) for block in FENCE.finditer(text)]


def run_console(text, folder, where):
    commands = re.split(r"^\$ ", text, flags=re.M)
    assert commands[0] == "", f"{where}: a console begins with a command"
    for entry in commands[1:]:
        lines = entry.split("\n")
        end = next(i for i, line in enumerate(lines) if not line.endswith("\\"))
        if lines[end].endswith("<<END"):
            end = lines.index("END", end)
        command, wanted = "\n".join(lines[: end + 1]), "\n".join(lines[end + 1 :])
        path = f"{os.environ['FCL_ARTIC_PROGRAMS']}:{os.environ['PATH']}"
        done = subprocess.run(["bash", "-c", command], cwd=folder, env={**os.environ, "PATH": path}, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300)
        assert done.returncode in (0, 1, 3), f"{where}: status {done.returncode} of {command}\n{done.stdout}"
        assert CHECKER.check_output(wanted or "\n", done.stdout or "\n", FLAGS), f"{where}: {command}\n{done.stdout}"


def run_session(text, names, where):
    test = doctest.DocTestParser().get_doctest(text, names, where, where, 0)
    said = []
    runner = doctest.DocTestRunner(CHECKER, verbose=False, optionflags=FLAGS)
    result = runner.run(test, out=said.append, clear_globs=False)
    assert result.attempted > 0, f"{where}: no >>>"
    assert result.failed == 0, "".join(said)
    names.update(test.globs)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(MANUAL)))
def test_what_the_page_shows_runs_as_shown(page, tmp_path, monkeypatch):
    (tmp_path / "data").symlink_to(ROOT / "data")
    monkeypatch.chdir(tmp_path)
    names = {}
    for line, kind, text in blocks(page):
        where = f"{page.relative_to(ROOT)}:{line}"
        if kind == "console":
            run_console(text, tmp_path, where)
        elif kind == "pycon":
            run_session(text, names, where)
        elif kind.startswith("{literalinclude}"):
            file = (page.parent / kind.split()[1]).resolve()
            assert file.is_file() and any(folder in file.parents for folder in RUN_BY_OTHER_TESTS), where
            shown = file.read_text()
            for marker in re.findall(r"^:(?:start-after|end-before): (.*)$", text, re.M):
                assert shown.count(marker.strip('"')) == 1, f"{where}: {marker}"
        elif kind.startswith("{code-block}"):
            assert ":class: elsewhere" in text, f"{where}: what is not run says so"
        else:
            assert re.match(r"\{(toctree|doxygenfile|eval-rst|figure|man-page|note|warning|image)\}", kind), \
                f"{where}: a block of kind '{kind}' is run by nobody"


def test_a_wrong_output_is_seen(tmp_path):
    with pytest.raises(AssertionError):
        run_console("$ echo free\ncontact\n", tmp_path, "here")
    with pytest.raises(AssertionError):
        run_console("$ exit 2\n", tmp_path, "here")
    with pytest.raises(AssertionError):
        run_session(">>> 1 + 1\n3\n", {}, "here")
    run_console("$ echo free\nfr...\n", tmp_path, "here")


def test_the_reference_names_everything():
    python = (MANUAL / "reference" / "python.md").read_text()
    shown = set(re.findall(r"^\.\. auto(?:class|function|data):: fcl_artic\.(\w+)$", python, re.M))
    assert shown == set(fcl_artic.__all__) - {"__version__"}
    pages = "".join(page.read_text() for page in (MANUAL / "reference").glob("cpp*.md"))
    include = ROOT / "include" / "fcl_artic"
    headers = {str(path.relative_to(include)) for path in include.rglob("*.h")}
    # fcl_artic.h includes the others; abi.h is the linker's; export.h is a macro; fcl_names.h repeats FCL's names.
    unnamed = {"fcl_artic.h", "abi.h", "export.h", "fcl_names.h"}
    assert set(re.findall(r"\{doxygenfile\} (\S+)", pages)) == headers - unnamed


def test_no_line_of_a_formula_is_taken_for_a_list():
    """A paragraph's line that begins with "- " or "+ " becomes a list's item: the operator belongs before the break."""
    pages = [*(ROOT / "doc").glob("*.md"), *PAGES]
    for page in pages:
        lines = FENCE.sub(lambda block: "\n" * block[0].count("\n"), page.read_text()).split("\n")
        for i in range(1, len(lines)):
            begins_list = re.match(r"[-+*] ", lines[i]) and re.match(r"\w|\(", lines[i - 1])
            assert not begins_list or lines[i - 1].endswith((".", ":")), f"{page.relative_to(ROOT)}:{i + 1}: {lines[i]}"


def test_every_page_is_in_a_table_of_contents():
    listed = set()
    for page in PAGES:
        for _, kind, text in blocks(page):
            if kind.startswith("{toctree}"):
                listed |= {(page.parent / f"{entry}.md").resolve() for entry in re.findall(r"^(?!:)(\S+)$", text, re.M)}
    assert set(PAGES) - listed == {MANUAL / "index.md"}
