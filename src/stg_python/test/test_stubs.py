"""The types that editors read are those of the module, and every public name is documented."""

import ast
import inspect
import pathlib
import re
import unittest

import stg
from stg import _core, wrappers

# The stub lies beside the module's sources.
STUB = pathlib.Path(inspect.getsourcefile(wrappers)).resolve().with_name("_core.pyi")


def declared():
    """Returns {name: None, or for a class {member: parameters or None}} of the stub."""
    names = {}
    for node in ast.parse(STUB.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            names[node.name] = {
                m.name if isinstance(m, ast.FunctionDef) else m.target.id: (
                    [a.arg for a in m.args.args + m.args.kwonlyargs if a.arg != "self"]
                    if isinstance(m, ast.FunctionDef)
                    else None
                )
                for m in node.body
                if isinstance(m, (ast.FunctionDef, ast.AnnAssign))
            }
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = [a.arg for a in node.args.args]
        elif isinstance(node, ast.AnnAssign):
            names[node.target.id] = None
    return names


def parameters(function):
    """Returns the names of a bound function's parameters, as pybind11 writes them."""
    signature = function.__doc__.splitlines()[0]
    inside = signature[signature.index("(") + 1 : signature.rindex(") ->")]
    return [n for n in re.findall(r"(?:^|, )(\w+): ", inside) if n not in ("self", "arg0")]


class Stubs(unittest.TestCase):
    def test_every_name_of_the_engine_is_declared_and_nothing_else(self):
        public = {n for n in vars(_core) if not n.startswith("_") or n == "__version__"}
        self.assertEqual(set(declared()), public)

    def test_classes_have_the_declared_members(self):
        for name, members in declared().items():
            if not isinstance(members, dict) or name == "UserError":
                continue
            bound = {
                m for m in vars(getattr(_core, name))
                if not m.startswith("_") or m in ("__init__", "__getitem__")
            }  # fmt: skip
            if name == "Scenario":
                bound.discard("__init__")  # pybind11's, which refuses
            self.assertEqual(set(members), bound, name)

    def test_functions_have_the_declared_parameters(self):
        for name, members in declared().items():
            if isinstance(members, list):
                self.assertEqual(parameters(getattr(_core, name)), members, name)
                continue
            for member, wanted in (members or {}).items():
                function = getattr(getattr(_core, name), member, None)
                if wanted and member != "__getitem__" and callable(function):
                    self.assertEqual(parameters(function), wanted, f"{name}.{member}")

    def test_every_public_name_has_a_docstring(self):
        for module in (stg, wrappers):
            for name in module.__all__:
                thing = getattr(module, name)
                self.assertTrue(inspect.getdoc(thing), name)
                for member, value in vars(thing).items() if inspect.isclass(thing) else ():
                    if not member.startswith("_") and callable(value):
                        self.assertTrue(inspect.getdoc(value), f"{name}.{member}")


if __name__ == "__main__":
    unittest.main()
