# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's configuration of the manual. Its sources are the repository's own pages, doc/*.md among them, so that links
between them hold here and there. CMake sets the environment (doc/manual/CMakeLists.txt)."""
import ast
import os
import pathlib
import re
import subprocess
import sys
from xml.etree import ElementTree

from docutils import nodes
from sphinx.util.docutils import SphinxDirective

ROOT = pathlib.Path(__file__).resolve().parents[2]

project = "fcl_artic"
author = "the fcl_artic authors"
copyright = "2026, the fcl_artic authors"
release = re.search(r"project\(fcl_artic VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)

root_doc = "doc/manual/index"
include_patterns = ["doc/**.md", "bench/README.md", "data/README.md", "CHANGELOG.md"]
exclude_patterns = ["build*", "install*", "out"]
extensions = ["myst_parser", "breathe", "sphinx.ext.autodoc", "sphinx_copybutton"]

myst_heading_anchors = 3
myst_enable_extensions = ["colon_fence", "deflist"]
suppress_warnings = ["myst.header"]  # pages of doc/ go from # to ###

breathe_projects = {"fcl_artic": os.environ["FCL_ARTIC_DOXYGEN_XML"]}
breathe_default_project = "fcl_artic"
breathe_default_members = ("members", "undoc-members")
breathe_show_include = False
cpp_id_attributes = ["FCL_ARTIC_EXPORT"]
primary_domain = None
highlight_language = "text"
smartquotes = False  # primes of the proofs stay primes

autodoc_member_order = "groupwise"
autodoc_typehints = "none"
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True
copybutton_line_continuation_character = "\\"
copybutton_here_doc_delimiter = "END"

html_theme = "furo"
html_title = f"fcl_artic {release}"
html_static_path = ["static"]
html_css_files = ["manual.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_additional_pages = {"index": "to_manual.html"}
templates_path = ["templates"]


def by_header(folder):
    """Gives the headers of Doxygen's XML what is declared in them, which Doxygen has at the namespace, so that a page may
    show one header. Where `@throws` lists several exceptions, they become one entry: Sphinx knows one name for each."""
    members = {}  # by header, then by kind of member
    for path in folder.glob("namespace*.xml"):
        for section in ElementTree.parse(path).iterfind("compounddef/sectiondef"):
            for member in section.iterfind("memberdef"):
                header = member.find("location").get("file")
                members.setdefault(header, {}).setdefault(section.get("kind"), []).append(member)
    for path in folder.glob("*.xml"):
        tree = ElementTree.parse(path)
        for compound in tree.iterfind("compounddef[@kind='file']"):
            for namespace in compound.findall("innernamespace"):
                compound.remove(namespace)
            for kind, found in members.get(compound.find("location").get("file"), {}).items():
                section = ElementTree.Element("sectiondef", kind=kind)
                section.extend(found)
                compound.insert(list(compound).index(compound.find("briefdescription")), section)
        for names in tree.iterfind(".//parameterlist[@kind='exception']/parameteritem/parameternamelist"):
            first, *others = names.findall("parametername")
            for other in others:
                first.text += ", " + other.text
                names.remove(other)
        tree.write(path, encoding="utf-8", xml_declaration=True)


by_header(pathlib.Path(os.environ["FCL_ARTIC_DOXYGEN_XML"]))


sys.path.append(str(ROOT / "python"))  # behind the built module
from signatures import decorators, members, readable  # noqa: E402

STUB = (ROOT / "python" / "fcl_artic" / "_fcl_artic.pyi").read_text()
TYPES = {f"fcl_artic.{name}": readable(node.returns if isinstance(node, ast.FunctionDef) else node.annotation)
         for name, node in members(STUB) if isinstance(node, ast.AnnAssign) or "property" in decorators(node)}


def signature(app, what, name, thing, options, parameters, result):
    """The type of a property; of a function what its docstring begins with."""
    if name in TYPES:
        return "()", TYPES[name]
    docstring = (thing.__init__ if what == "class" else thing).__doc__ or ""
    shown = re.match(r"\w+(\(.*\))(?: -> (.*))?$", docstring.split("\n")[0])
    if shown:
        return shown[1], shown[2] or ""
    return ("", "") if what == "class" else None


def without_signature(app, what, name, thing, options, lines):
    """Drops the signatures that a docstring begins with."""
    while lines and lines[0].startswith(name.rsplit(".", 1)[-1] + "("):
        del lines[0]


class ManPage(SphinxDirective):
    """A man page of doc/man, as man shows it."""

    required_arguments = 1

    def run(self):
        page = ROOT / "doc" / "man" / self.arguments[0]
        self.env.note_dependency(str(page))
        text = subprocess.run(["groff", "-man", "-Tutf8", "-P-cbou", "-rLL=80n", page], check=True, capture_output=True,
                              text=True).stdout
        return [nodes.literal_block(text, text.strip("\n"), language="text")]


def setup(app):
    app.connect("autodoc-process-signature", signature)
    app.connect("autodoc-process-docstring", without_signature)
    app.add_directive("man-page", ManPage)
