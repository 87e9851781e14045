# SPDX-License-Identifier: BSD-3-Clause
"""The signatures of the stub, _fcl_artic.pyi, in words, for docstrings, errors and the manual.

As a program it writes the table that src/functions.cpp includes: signatures.py STUB TABLE."""
import ast
import json
import pathlib
import re
import sys

SHORT = {"npt.ArrayLike": "array", "_Doubles": "array of float", "_Pose": "pose", "_Path": "path",
         "_Pair": "tuple[str, str]", "_HasTree": "KinematicTree | Robot | World", "_Shape": "Geometry | mesh",
         "_HasFaces": "mesh", "_Progress": "callable"}


def readable(node):
    """A type or parameters of the stub in words: the private names of types are written out."""
    text = re.sub(r"npt\.NDArray\[(?:np\.)?(\w+)\]", r"array of \1", ast.unparse(node))
    return re.sub(r"npt\.ArrayLike|\b_[A-Z]\w+", lambda name: SHORT[name[0]], text)


def members(stub):
    """Functions, properties and annotated members of the stub, each with its name: World.check, box."""
    for node in ast.parse(stub).body:
        for inner in node.body if isinstance(node, ast.ClassDef) else [node]:
            prefix = f"{node.name}." if inner is not node else ""
            if isinstance(inner, ast.FunctionDef):
                yield prefix + inner.name, inner
            elif isinstance(inner, ast.AnnAssign) and prefix:
                yield prefix + inner.target.id, inner


def decorators(function):
    return [ast.unparse(decorator) for decorator in function.decorator_list]


def parameters(function, query_options):
    """A function's parameters. `{name}` stands where the value does that it has if it is left out."""
    given = function.args.args[1:] if [a.arg for a in function.args.args[:1]] == ["self"] else function.args.args
    optional = len(given) - len(function.args.defaults)
    named = function.args.kwonlyargs  # all can be left out
    options = "request" in {argument.arg for argument in named}
    if options:  # they are the fields of Request
        named = [argument for argument in named if argument.arg not in query_options]
    shown = [readable(a) + (f" = {{{a.arg}}}" if i >= optional else "") for i, a in enumerate(given)]
    if named:
        shown += ["*", *(f"{readable(a)} = {{{a.arg}}}" for a in named)]
    return ", ".join(shown + ["**options"] if options else shown)


def signatures(stub):
    """By the name of each function, and of each member that can be set, a line for each way to use it."""
    found = {}
    all_members = list(members(stub))
    (request,) = (node for name, node in all_members if name == "Request.__init__")
    query_options = {argument.arg for argument in request.args.kwonlyargs} | {"request"}
    for name, node in all_members:
        shown = name.rsplit(".", 1)[-1]
        if isinstance(node, ast.AnnAssign):
            line = readable(node)
        elif "property" in decorators(node):
            continue
        elif f"{shown}.setter" in decorators(node):
            line = f"{shown}: {readable(node.args.args[1].annotation)}"
        elif shown == "__init__":
            line = f"{name.split('.')[0]}({parameters(node, query_options)})"
        else:
            line = f"{shown}({parameters(node, query_options)}) -> {readable(node.returns)}"
        found.setdefault(name, []).append(line)
    return {name: "\n".join(lines) for name, lines in found.items()}


if __name__ == "__main__":
    text = "".join(f"{{{json.dumps(name)}, {json.dumps(lines)}}},\n"
                   for name, lines in signatures(pathlib.Path(sys.argv[1]).read_text()).items())
    pathlib.Path(sys.argv[2]).write_text(text)
