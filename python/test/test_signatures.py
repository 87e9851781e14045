# SPDX-License-Identifier: BSD-3-Clause
"""Signatures as in the stub, in docstrings and in errors; nobody sees types of C++."""
import ast
import inspect
import pathlib
import re

import numpy as np
import pytest

import fcl_artic

STUB = pathlib.Path(fcl_artic.__file__).with_name("_fcl_artic.pyi")
FOREIGN = re.compile(r"\bhandle\b|::|pybind|_fcl_artic|C\+\+|\barg\d|Invoked with|incompatible")


def functions():
    """Every function of the module, with its name in fcl_artic; of a property what sets it."""
    for name in fcl_artic.__all__:
        owner = getattr(fcl_artic, name)
        if inspect.isbuiltin(owner):
            yield name, owner
        elif isinstance(owner, type) and owner.__module__ == "fcl_artic._fcl_artic":
            for member, value in vars(owner).items():
                if isinstance(value, property):
                    if value.fset:
                        yield f"{name}.{member}", value.fset
                elif type(getattr(owner, member)).__name__ in ("builtin_function_or_method", "instancemethod"):
                    yield f"{name}.{member}", getattr(owner, member)


# (Since its version 3, pybind11 has a function of its own in each class.)
FUNCTIONS = {name: function for name, function in functions() if "._pybind11_" not in name}


def test_all_functions_are_found():
    assert len(FUNCTIONS) > 200 and {"box", "World.check", "World.__init__", "Robot.allowed"} <= set(FUNCTIONS)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_no_docstring_has_types_of_cpp(name):
    assert not FOREIGN.search(FUNCTIONS[name].__doc__ or ""), FUNCTIONS[name].__doc__


def test_docstrings_begin_with_the_stub():
    for node in ast.parse(STUB.read_text()).body:
        for inner in node.body if isinstance(node, ast.ClassDef) else [node]:
            if not isinstance(inner, ast.FunctionDef) or any(isinstance(d, ast.Attribute) or d.id == "property"
                                                             for d in inner.decorator_list):
                continue
            name = inner.name if inner is node else f"{node.name}.{inner.name}"
            if name not in FUNCTIONS:
                assert name.startswith("_") or inner.name in ("__hash__", "__eq__"), name
                continue
            lines = FUNCTIONS[name].__doc__.split("\n\n")[0].split("\n")
            assert all(line.startswith((node if inner.name == "__init__" else inner).name + "(") for line in lines), name
            # Each argument stands in one of the lines, but for the options of queries, which are Request's.
            text = " ".join(lines)
            options = "**options" in text
            for argument in inner.args.args + inner.args.kwonlyargs:
                if argument.arg != "self" and not (options and hasattr(fcl_artic.Request, argument.arg)):
                    assert argument.arg == "request" or re.search(rf"\b{argument.arg}: ", text), (name, argument.arg)


def test_signatures_name_types_and_the_values_of_what_is_left_out():
    def first(function):
        return function.__doc__.split("\n")[0]

    assert first(fcl_artic.box) == "box(size: array) -> Geometry"
    assert first(fcl_artic.Mimic.__init__) == "Mimic(master: str, multiplier: float = 1.0, offset: float = 0.0)"
    assert first(fcl_artic.World.check) == "check(q0: array, q1: array, **options) -> Result"
    assert first(fcl_artic.World.set_visibility) == (
        "set_visibility(executor: VisibilityExecutor | str = 'cpu', *, resolution: int = 32) -> None")
    assert first(fcl_artic.World.attach) == ("attach(name: str, link: str | int, offset: pose | None = None, "
                                             "touch_links: Sequence[str] = []) -> None")
    assert fcl_artic.World.check.__doc__.split("\n")[1:4] == [
        "check(q0: JointMotion | JointTrajectory, **options) -> Result", "",
        "Finds the first contact on the straight way from q0 to q1 in joint space, or proves that there is none."]


@pytest.mark.parametrize("name", FUNCTIONS)
def test_no_error_for_wrong_arguments_has_types_of_cpp(name):
    for arguments in [(3.5,) * n for n in range(9)] + [(object(),) * 40]:
        for options in ({}, {"no_such_option": 1}):
            try:
                FUNCTIONS[name](*arguments, **options)
            except (TypeError, ValueError, OSError) as error:
                assert not FOREIGN.search(re.sub(r"<[^<>]* object at [^<>]*>", "", str(error))), str(error)


def refused(call):
    with pytest.raises(TypeError) as error:
        call()
    assert not FOREIGN.search(re.sub(r"<[^<>]* object at [^<>]*>", "", str(error.value))), str(error.value)
    return str(error.value)


def test_errors_end_with_the_signature(world, hit):
    assert refused(lambda: fcl_artic.box(1, 1, 1)) == (
        "box: wrong arguments: 1, 1, 1\nIt takes:\n    box(size: array) -> Geometry")
    assert refused(lambda: fcl_artic.sphere(rad=1)) == (
        "sphere: wrong arguments: kwargs: rad=1\nIt takes:\n    sphere(radius: float) -> Geometry")
    assert refused(lambda: fcl_artic.Mimic(3)).endswith(
        "It takes:\n    Mimic(master: str, multiplier: float = 1.0, offset: float = 0.0)")
    assert refused(lambda: world.remove(3)).endswith("It takes:\n    remove(name: str) -> None")
    assert "check(q0: JointMotion | JointTrajectory, **options) -> Result" in refused(lambda: world.check())
    assert refused(lambda: setattr(fcl_artic.Mimic("a"), "master", 3)).endswith("It takes:\n    master: str")
    # Where a value is looked at only within the function.
    assert refused(lambda: world.check(*hit, redon=3)).startswith("World.check: wrong arguments\nIt takes:\n    check(")
    assert refused(lambda: world.set_margin("a", 3, 1.0)).startswith("World.set_margin: wrong arguments")


def test_errors_of_callbacks_stay_as_they_are(world, hit):
    class Odd(TypeError):
        pass

    def progress(part):
        raise Odd("(): incompatible with me")

    motion = fcl_artic.Motion.bounded(lambda t: progress(t), lambda a, b: (1, 0), derivatives=False)
    with pytest.raises(Odd, match="incompatible with me"):
        motion.pose(0.5)
    assert np.isfinite(world.check(*hit).t_lower)
