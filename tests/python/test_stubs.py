"""The stub of the compiled part says what is there, and what is public is annotated and documented."""

import ast
import dataclasses
import inspect
import re
from pathlib import Path

import glint
from glint import _glint

PACKAGE = Path(glint.__file__).parent


def stub():
    return ast.parse((PACKAGE / "_glint.pyi").read_text())


def arguments_in_stub(node):
    return [a.arg for a in node.args.args if a.arg != "self"]


def arguments_of(function):
    """pybind11 writes the signature into the first line of the documentation."""
    inside = re.match(r"\w+\((.*)\) -> ", function.__doc__).group(1)
    return [a for a in re.findall(r"(?:^|, )(\w+): ", inside) if a != "self"]


def test_package_is_marked_as_typed():
    assert (PACKAGE / "py.typed").exists()


def test_functions_of_the_stub_are_those_of_the_module():
    written = {n.name: arguments_in_stub(n) for n in stub().body if isinstance(n, ast.FunctionDef)}
    there = {name: arguments_of(f) for name, f in vars(_glint).items() if inspect.isroutine(f)}
    assert written == there


def test_classes_of_the_stub_are_those_of_the_module():
    classes = {n.name: n for n in stub().body if isinstance(n, ast.ClassDef)}
    assert set(classes) == {name for name, c in vars(_glint).items() if inspect.isclass(c)}
    for name, node in classes.items():
        there = {n for n in vars(getattr(_glint, name)) if not n.startswith("__") and n != "_pybind11_conduit_v1_"}
        assert there == {n.name for n in node.body if isinstance(n, ast.FunctionDef)}


def test_what_is_public_is_documented_and_annotated():
    for name in glint.__all__:
        item = getattr(glint, name)
        assert item.__doc__ and not item.__doc__.startswith(name + "("), f"{name} has no documentation"
        if inspect.isfunction(item):
            signature = inspect.signature(item)
            assert signature.return_annotation is not inspect.Signature.empty, name
            for parameter in signature.parameters.values():
                assert parameter.annotation is not inspect.Parameter.empty, f"{name}({parameter.name})"
                assert parameter.name in item.__doc__, f"{name}: {parameter.name} is not documented"
        if dataclasses.is_dataclass(item):
            for field in dataclasses.fields(item):
                if field.name in vars(item).get("__annotations__", {}):
                    assert field.name in item.__doc__, f"{name}.{field.name} is not documented"
