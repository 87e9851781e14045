# SPDX-License-Identifier: BSD-3-Clause
"""Sphinx's configuration of the manual. Its sources are the repository's own pages, doc/*.md among them, so that links
between them hold here and there. CMake sets the environment (doc/manual/CMakeLists.txt)."""
import ast
import os
import pathlib
import re
import subprocess
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


def stubs():
    """The functions and properties of _fcl_artic.pyi by their names, the first of overloads."""
    found = {}

    def visit(prefix, body):
        for node in body:
            if isinstance(node, ast.ClassDef):
                visit(f"{prefix}.{node.name}", node.body)
            elif isinstance(node, ast.FunctionDef):
                found.setdefault(f"{prefix}.{node.name}", node)

    visit("fcl_artic", ast.parse((ROOT / "python" / "fcl_artic" / "_fcl_artic.pyi").read_text()).body)
    return found


STUBS = stubs()
REQUEST = {argument.arg for argument in STUBS["fcl_artic.Request.__init__"].args.kwonlyargs} | {"request"}
SHORT = {"npt.ArrayLike": "array", "_Doubles": "array of float", "_Pose": "pose", "_Path": "path",
         "_Pair": "tuple[str, str]", "_HasTree": "KinematicTree | Robot | World", "_Shape": "Geometry | mesh",
         "_Progress": "callable"}


def readable(text):
    """A type or parameters of the stubs in words: the private names of types are written out."""
    text = re.sub(r"npt\.NDArray\[(?:np\.)?(\w+)\]", r"array of \1", text)
    return re.sub(r"npt\.ArrayLike|\b_[A-Z]\w+", lambda name: SHORT[name[0]], text)


def shown_parameters(stub, docstring):
    """The stub's parameters with the values that they have if they are left out, which pybind11's signature names."""
    values = dict(re.findall(r"(\w+): [^=,()]+ = (\([^)]*\)|\[[^\]]*\]|[^,)]+)", docstring.split("\n", 1)[0]))
    shown, options = [], False
    given = stub.args.args[1:] if stub.args.args[:1] and stub.args.args[0].arg == "self" else stub.args.args
    optional = len(given) - len(stub.args.defaults)
    is_query = "request" in {argument.arg for argument in stub.args.kwonlyargs}
    for i, argument in enumerate(given + stub.args.kwonlyargs):
        if i == len(given):
            shown.append("*")
        if is_query and argument.arg in REQUEST:  # the options of a query are the fields of Request
            options = True
            continue
        text = ast.unparse(argument)
        shown.append(f"{text} = {values.get(argument.arg, '...')}" if i >= optional else text)
    if options:
        shown = [text for i, text in enumerate(shown) if text != "*" or i + 1 < len(shown)] + ["**options"]
    return readable(", ".join(shown))


def signature(app, what, name, thing, options, parameters, result):
    """The stubs' signature in place of pybind11's, which knows no types of arrays."""
    if what == "class":
        stub = STUBS.get(f"{name}.__init__")
        return (f"({shown_parameters(stub, thing.__init__.__doc__ or '')})", "") if stub else ("", "")
    if name not in STUBS:
        return None
    stub = STUBS[name]
    return f"({shown_parameters(stub, thing.__doc__ or '')})", readable(ast.unparse(stub.returns))


def without_signature(app, what, name, thing, options, lines):
    """Drops the signature that pybind11 puts before a text."""
    if lines and re.match(rf"{name.rsplit('.', 1)[-1]}\(", lines[0]):
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
