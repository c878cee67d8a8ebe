"""The stub and the extension have the same names and arguments; every public name is documented and annotated."""
import ast
import inspect
import os
import re
import shutil
import subprocess
import sys
import unittest

import support

import numpy as np
import softarm
from softarm import _softarm

SHAPE = r"\((n|k|p)(, \w+)*,?\)"
UNITS = ("_s", "_m", "_kg", "_pa", "_n", "_nm", "_nm2", "_rad", "_per_m", "_xyzw")
PACKAGE = os.path.dirname(softarm.__file__)


def public(names):
    return {name for name in names if not name.startswith("_") or name == "__version__"}


def stub_of():
    with open(os.path.join(PACKAGE, "_softarm.pyi"), encoding="utf-8") as file:
        return ast.parse(file.read())


def names_in(body):
    names = set()
    for one in body:
        if isinstance(one, (ast.ClassDef, ast.FunctionDef)):
            names.add(one.name)
        elif isinstance(one, ast.AnnAssign):
            names.add(one.target.id)
    return public(names)


def arguments(function):
    return [one.arg for one in function.args.args if one.arg != "self"]


def said_arguments(function):
    """As pybind11 prints them in the first line of a docstring."""
    line = function.__doc__.splitlines()[0]
    inside = line[line.index("(") + 1:line.rindex(")")]
    return [name for name in re.findall(r"(?:^|, )(\w+): ", inside) if name != "self"]


class Stubs(unittest.TestCase):
    def test_module_and_stub_have_the_same_names(self):
        self.assertEqual(names_in(stub_of().body), public(vars(_softarm)))

    def test_classes_have_the_same_members(self):
        for one in stub_of().body:
            if isinstance(one, ast.ClassDef) and one.name.endswith(("Handle", "Options")):
                self.assertEqual(names_in(one.body), public(vars(getattr(_softarm, one.name))), one.name)

    def test_functions_have_the_same_arguments(self):
        seen = 0
        for one in stub_of().body:
            if isinstance(one, ast.FunctionDef):
                self.assertEqual(arguments(one), said_arguments(getattr(_softarm, one.name)), one.name)
                seen += 1
            for method in (m for m in getattr(one, "body", []) if isinstance(one, ast.ClassDef)):
                if (isinstance(method, ast.FunctionDef) and method.name != "__init__" and not method.decorator_list
                        and one.name.endswith("Handle")):
                    found = said_arguments(getattr(getattr(_softarm, one.name), method.name))
                    self.assertEqual(arguments(method), [name for name in found if name != "arg0"], f"{one.name}.{method.name}")
                    seen += 1
        self.assertGreater(seen, 20)

    def test_errors_are_one_family(self):
        for name in ("ArmError", "BagError", "CsvError", "IdentifyError"):
            self.assertTrue(issubclass(getattr(softarm, name), softarm.Error))


class Package(unittest.TestCase):
    def test_all_is_what_there_is(self):
        self.assertEqual(set(softarm.__all__), {name for name in vars(softarm) if name == "__version__" or (
            not name.startswith("_") and not inspect.ismodule(getattr(softarm, name)))})
        self.assertTrue(os.path.exists(os.path.join(PACKAGE, "py.typed")))

    def test_everything_is_documented_and_annotated(self):
        for name in softarm.__all__:
            thing = getattr(softarm, name)
            if name == "__version__":
                continue
            self.assertTrue(thing.__doc__ and len(thing.__doc__) > 20, name)
            members = [(name, thing)] if inspect.isfunction(thing) else [
                (f"{name}.{key}", getattr(value, "fget", None) or getattr(value, "__func__", value)) for key, value in
                vars(thing).items() if not key.startswith("_") or key == "__init__"] if name not in (
                    "ArmError", "BagError", "CsvError", "Error", "IdentifyError", "SoftarmWarning") else []
            for label, function in members:
                if not inspect.isfunction(function):
                    continue
                signature = inspect.signature(function)
                for argument in signature.parameters.values():
                    if argument.name != "self":
                        self.assertIsNot(argument.annotation, inspect.Parameter.empty, f"{label}({argument.name})")
                self.assertIsNot(signature.return_annotation, inspect.Signature.empty, label)
                if not label.endswith("__init__"):
                    self.assertTrue(function.__doc__, label)

    def test_arrays_that_are_named_are_there(self):
        """What docstrings and annotations of the results promise."""
        arm = softarm.load_arm("online_200mm")
        shapes = softarm.Model(arm).solve(jacobians=True)
        found = softarm.estimate(softarm.read_bag(arm, support.bag()))
        for thing in (shapes, shapes.jacobians, found, found.mismatch):
            for name in type(thing).__annotations__:
                self.assertTrue(hasattr(thing, name), name)
        for name in ("EI_nm2", "payload_kg", "tip_p_base_m"):
            self.assertIn(name, softarm.Estimates.__doc__)
        for thing, others in ((found, {"name", "summary", "warnings", "alarms", "mismatch"}), (found.mismatch, {"description"}),
                              (shapes, {"arclength_m", "body_names", "segment_names", "jacobians"}),
                              (shapes.jacobians, {"inputs", "constants"})):
            self.assertEqual(set(vars(thing)) - others, set(type(thing).__annotations__))

    def test_docstrings_name_arguments_shapes_and_units(self):
        """Every argument; of arrays the shape, and the unit where the name has none."""
        arrays = 0
        for name in softarm.__all__:
            thing = getattr(softarm, name)
            if inspect.isfunction(thing):
                self.expect_arguments(name, thing, thing.__doc__)
            if not inspect.isclass(thing) or issubclass(thing, (Exception, Warning)):
                continue
            about = " ".join(filter(None, [thing.__doc__, getattr(thing.__init__, "__doc__", None)]))
            for member, given in inspect.getmembers(thing):
                if inspect.isfunction(given) and (not member.startswith("_") or thing.__init__.__doc__ and member == "__init__"):
                    self.expect_arguments(f"{name}.{member}", given, (given.__doc__ or "") + about)
                elif isinstance(given, property) and given.fget.__annotations__["return"] is np.ndarray:
                    self.assertRegex(given.__doc__, SHAPE, f"{name}.{member}")
                    arrays += 1
                    if not member.endswith(UNITS):
                        self.assertRegex(given.__doc__, r"\b(s|m|kg|Pa|N|rad|bool)\b|as the driver|base's body", f"{name}.{member}")
            for field in getattr(thing, "_fields", ()):
                self.assertIn(f"``{field}``", about + "``name`` ``unit``", f"{name}.{field}")
            for field, kind in thing.__dict__.get("__annotations__", {}).items():
                if kind is np.ndarray:
                    self.assertTrue(f"``{field}``" in about or "``points_by_...``" in about and field.startswith("points_by_"),
                                    f"{name}.{field}")
                    self.assertRegex(about, SHAPE, name)
                    arrays += 1
        self.assertGreater(arrays, 50)

    def expect_arguments(self, label, function, text):
        for argument in inspect.signature(function).parameters.values():
            if argument.name not in ("self", "arm", "others"):
                self.assertIn(f"``{argument.name}``", text, f"{label}({argument.name})")

    def test_a_package_without_its_compiled_part_says_so(self):
        alone = support.path("alone")
        shutil.copytree(PACKAGE, os.path.join(alone, "softarm"), ignore=shutil.ignore_patterns("*.so", "__pycache__"))
        done = subprocess.run([sys.executable, "-c", "import softarm"], env={**os.environ, "PYTHONPATH": alone},
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(done.stderr.splitlines()[-1], "^ImportError: softarm was installed without its compiled part")


if __name__ == "__main__":
    support.main()
