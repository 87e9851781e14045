#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Holds a manual page to what its program says of itself: each option of each verb stands in the section OPTIONS, beside its
default; and each option of that section is one of a verb.

man_page.py PROGRAM PAGE [LEAST]      LEAST: how many options there are at least"""
import pathlib
import re
import subprocess
import sys

NAME = re.compile(r"(?<![\w-])--[a-z][a-z0-9-]*")


def help_of(program, verbs):
    return subprocess.run([program, *verbs, "--help"], capture_output=True, text=True, check=True).stdout


def verbs_of(program, verbs=()):
    """All verbs, and verbs of verbs, each with its help."""
    text = help_of(program, verbs)
    yield verbs, text
    names = re.search(r"^Subcommands:\n((?:  .*\n)+)", text, re.M)
    for name in re.findall(r"^  (\w+)", names[1], re.M) if names else []:
        yield from verbs_of(program, (*verbs, name))
    if verbs == ("certify",):  # edges have options of their own
        yield ("certify", "--merge"), help_of(program, ("certify", "--merge"))


def options_of(text):
    """Names of the options that a help lists, each with its default, None where it shows none."""
    for names, rest in re.findall(r"^  (-\S+)(.*)", text, re.M):
        default = re.match(r" [^ =]+=([a-z0-9.-]+)(?=\s|$)", rest)  # not of LINK=FILE, nor lists
        for name in NAME.findall(names.replace(",", " ")):
            yield name, default[1] if default else None
        for name in re.findall(r", (--[a-z-]+)", re.split(r"  ", names + rest)[0]):  # "--from Q, --to Q"
            yield name, None


def entries_of(page):
    """Texts of the page's entries, from one .TP to the next."""
    options = page[page.index("\n.SH OPTIONS") : page.index("\n.SH EXIT STATUS")]
    plain = options.replace(r"\-", "-").replace(r"\fR", "").replace(r"\fB", "").replace(r"\fP", "").replace(r"\fI", "")
    return re.split(r"^\.(?:TP|SS|PP).*$", plain, flags=re.M)


def numbers_in(text):
    return {float(word.replace(",", "")) for word in re.findall(r"-?\d[\d,]*(?:\.\d+)?(?:e-?\d+)?", text)}


def main(program, page, least=15):
    entries = entries_of(pathlib.Path(page).read_text())
    of_page = {}
    for entry in entries:
        for name in NAME.findall(entry):
            of_page.setdefault(name, []).append(entry)
    faults, seen = [], set()
    for verbs, text in verbs_of(program):
        found = list(options_of(text))
        if verbs and not found:
            faults.append(f"no option was found in the help of {' '.join(verbs)}")
        for name, default in found:
            seen.add(name)
            if name not in of_page:
                faults.append(f"{name} of '{' '.join(verbs)}' is not in the page")
            elif default and re.fullmatch(r"-?[\d.]+(e-?\d+)?", default):
                if not any(float(default) in numbers_in(entry) for entry in of_page[name]):
                    faults.append(f"{name} of '{' '.join(verbs)}' is {default} by default, which the page does not say")
            elif default and not any(re.search(rf"\b{re.escape(default)}\b", entry) for entry in of_page[name]):
                faults.append(f"{name} of '{' '.join(verbs)}' is '{default}' by default, which the page does not say")
    faults += [f"{name} of the page is no option of any verb" for name in sorted(set(of_page) - seen)]
    print(f"{len(seen)} options of the program, {len(of_page)} of the page")
    print("\n".join(faults))
    return 1 if faults or len(seen) < int(least) else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
