"""The type stubs say of the module what it says of itself: names, parameters, and their defaults where they can be told."""

import ast
import inspect
import pathlib

import photonvdb
import pytest

STUBS = ast.parse(pathlib.Path(photonvdb.__file__).with_suffix(".pyi").read_text())
FUNCTIONS = {node.name: node for node in STUBS.body if isinstance(node, ast.FunctionDef)}
CLASSES = {node.name: node for node in STUBS.body if isinstance(node, ast.ClassDef)}


def methods(node):
    return {part.name: part for part in node.body if isinstance(part, ast.FunctionDef)}


def is_property(node):
    return any(isinstance(word, ast.Name) and word.id == "property" for word in node.decorator_list)


def assert_same_signature(stub, real):
    parameters = list(inspect.signature(real).parameters.values())
    arguments = stub.args
    placed = [parameter for parameter in parameters if parameter.kind is not parameter.KEYWORD_ONLY]
    named = [parameter for parameter in parameters if parameter.kind is parameter.KEYWORD_ONLY]
    assert [argument.arg for argument in arguments.posonlyargs + arguments.args] == [parameter.name for parameter in placed]
    assert [argument.arg for argument in arguments.kwonlyargs] == [parameter.name for parameter in named]
    optional = [parameter for parameter in placed if parameter.default is not parameter.empty]
    defaults = arguments.defaults + arguments.kw_defaults
    assert len(defaults) == len(optional + named)
    for default, parameter in zip(defaults, optional + named):
        # What is no literal in Rust reads `...`.
        if parameter.default is not ...:
            assert ast.literal_eval(default) == parameter.default, parameter.name


def test_every_name_has_a_stub():
    annotated = {node.target.id for node in STUBS.body if isinstance(node, ast.AnnAssign)}
    assert FUNCTIONS.keys() | CLASSES.keys() | annotated == set(photonvdb.__all__)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_take_what_their_stubs_say(name):
    assert_same_signature(FUNCTIONS[name], getattr(photonvdb, name))
    assert getattr(photonvdb, name).__doc__


@pytest.mark.parametrize("name", CLASSES)
def test_classes_have_what_their_stubs_say(name):
    real, stubs = getattr(photonvdb, name), methods(CLASSES[name])
    assert {part for part in vars(real) if not part.startswith("_")} == {part for part in stubs if not part.startswith("_")}
    for part, stub in stubs.items():
        assert hasattr(real, part)
        if not is_property(stub) and not part.startswith("_"):
            assert_same_signature(stub, getattr(real, part))
    assert real.__doc__
