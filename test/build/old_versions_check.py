#!/usr/bin/python3
"""Nothing newer than Ubuntu 20.04 has: g++ 9, CMake 3.16, Ceres 1.14, Eigen 3.3, fmt 6.1, pybind11 2.4, Python 3.8.

This finds what is known to be newer, in seconds. What proves it is `CXX=g++-9 scripts/test --debian 11`, where the compiler,
Ceres and Eigen are as old. CMake, fmt, pybind11 and Python are not quite, so here is more about these.
"""
import ast
import os
import re
import sys

import tree

# (what it looks for, since when, a line that has it)
CXX = [
    (r"\bceres::\w*Manifold\w*|\bAddResidualBlock.*Manifold", "Ceres 2.1", "ceres::QuaternionManifold q;"),
    (r"\bSetManifold\b", "Ceres 2.1", "problem.SetManifold(x, m);"),
    (r"\b(reshaped|colwise\(\)\.begin|rowwise\(\)\.begin)\b", "Eigen 3.4", "m.reshaped();"),
    (r"\bEigen::(seq|seqN|all|last|lastN|placeholders|indexing)\b", "Eigen 3.4", "v(Eigen::seq(0, 3))"),
    (r"\bEigen::(Vector|RowVector)<", "Eigen 3.4", "Eigen::Vector<double, 5> v;"),
    (r"\bEigen::(MatrixX|VectorX|RowVectorX|Matrix[2-4X]X?|Vector[2-4])<", "Eigen 3.4", "Eigen::VectorX<double> v;"),
    (r"\bEigen::(Matrix|Array)\w* \w+\{\{", "Eigen 3.4", "Eigen::MatrixXd m{{1, 2}, {3, 4}};"),
    (r"#include <fmt/(std|args|xchar)\.h>", "fmt 8 or 9", "#include <fmt/std.h>"),
    (r"#include <(concepts|ranges|span|bit|numbers|format|source_location|compare|coroutine|barrier|latch|semaphore|"
     r"stop_token|syncstream|version)>", "C++20", "#include <span>"),
    (r"\bstd::(span|numbers|ranges|bit_cast|ssize|erase_if|remove_cvref_t|midpoint|lerp|jthread|source_location)\b", "C++20",
     "std::ssize(v)"),
    (r"\.(starts_with|ends_with)\(", "C++20", 'name.starts_with("a")'),
    (r"\bstd::(from_chars|to_chars)\(.*(double|float|value_d)", "g++ 11", "std::from_chars(a, b, double_value)"),
    (r"max_num_line_search_step_size_iterations = (0|.*[?:] 0)\b", "Ceres 2.1 (1.14 refuses it)",
     "o.max_num_line_search_step_size_iterations = a ? 0 : b;"),
    (r"\bstd::execution\b", "a library that g++ 9 does not bring", "std::execution::par"),
    (r"\bpy::(module_|kw_only|pos_only|prepend|raise_from|type|local_exception)\b", "pybind11 2.6", "py::kw_only()"),
]
# All of fmt that is used, as fmt 6.1 has it.
FMT = {"arg", "format", "format_to", "format_to_n", "formatted_size", "formatter", "join", "make_format_args", "memory_buffer",
       "print", "string_view", "to_string", "vformat"}
# Older CMake takes these for errors, or overlooks them.
CMAKE = [
    (r"\bcmake_path\(", 3.20, "cmake_path(GET a b)"),
    (r"\bcmake_language\(", 3.18, "cmake_language(CALL a)"),
    (r"^\s*(block|return)\((PROPAGATE|SCOPE_FOR)", 3.25, "block(PROPAGATE a)"),
    (r"\bfile\((REAL_PATH|CHMOD|ARCHIVE_\w+|CONFIGURE|COPY_FILE|MAKE_DIRECTORY_RESULT)\b", 3.18, "file(REAL_PATH a b)"),
    (r"\bstring\((JSON|HEX)\b", 3.18, "string(JSON a GET b)"),
    (r"\bZIP_LISTS\b", 3.17, "foreach(a IN ZIP_LISTS b c)"),
    (r"\bmessage\(CHECK_", 3.17, 'message(CHECK_START "a")'),
    (r"\bfind_(program|library|file|path)\(.*\bREQUIRED\b", 3.18, "find_program(A a REQUIRED)"),
    (r"\bDISCOVERY_MODE\b", 3.18, "gtest_discover_tests(a DISCOVERY_MODE PRE_TEST)"),
    (r"\bUNITY_(GROUP|BUILD_MODE)\b", 3.18, "set_target_properties(a PROPERTIES UNITY_BUILD_MODE GROUP)"),
    (r"\bDevelopment\.(Module|Embed)\b", 3.18, "find_package(Python3 COMPONENTS Development.Module)"),
    (r"\bFILE_SET\b", 3.23, "target_sources(a PUBLIC FILE_SET HEADERS)"),
    (r"\bfind_package\(GTest (?!CONFIG)", 3.20, "find_package(GTest REQUIRED)"),  # that module knows no GTest::gmock
    (r"\bPATH_EQUAL\b|\bIS_(READABLE|WRITABLE|EXECUTABLE)\b", 3.24, "if(a PATH_EQUAL b)"),
    (r"\$<(PATH|LIST|LINK_GROUP|LINK_LIBRARY|DEVICE_LINK|COMPILE_ONLY|TARGET_RUNTIME_DLLS):", 3.18, "$<PATH:GET a>"),
    (r"\bcmake_minimum_required\(VERSION 3\.(1[7-9]|[2-9]\d)", 3.17, "cmake_minimum_required(VERSION 3.18)"),
    (r"\bconfigure_file\(.*_PERMISSIONS", 3.19, "configure_file(a b NO_SOURCE_PERMISSIONS)"),
]
SCRIPTS = [
    (r"\bctest\b.* --test-dir\b", 3.20, "ctest --test-dir build"),
    (r"\bcmake\b.* --(fresh|preset|workflow)\b", 3.19, "cmake --preset a"),
    (r"\bctest\b.* --preset\b", 3.20, "ctest --preset a"),
]
PYTHON = [
    (r"\.(removeprefix|removesuffix)\(", "Python 3.9", 'name.removeprefix("a")'),
    (r"\bcancel_futures=", "Python 3.9", "pool.shutdown(cancel_futures=True)"),
    (r"\bzip\(.*\bstrict=", "Python 3.10", "zip(a, b, strict=True)"),
    (r"\bfunctools\.cache\b|\bmath\.(lcm|nextafter|ulp|cbrt|exp2)\b|\bitertools\.pairwise\b", "Python 3.9", "functools.cache"),
    (r"\.set_[xy]ticks\(.*(fontsize=|\), )", "matplotlib 3.5", "axes.set_yticks(range(len(a)), a)"),
    (r"\blayout=\"(constrained|tight)\"", "matplotlib 3.5", 'plt.subplots(2, layout="constrained")'),
    (r"\bsubplots\(.*[,(] *(width|height)_ratios=", "matplotlib 3.6", "plt.subplots(1, 2, width_ratios=[1, 2])"),
    (r"\blegend\(.*\bncols=", "matplotlib 3.6", "axes.legend(fontsize=8, ncols=3)"),
    (r"\b(import|from) (tomllib|graphlib|zoneinfo)\b", "Python 3.9", "import tomllib"),
    (r"(:|->) *(list|dict|tuple|set|frozenset)\[", "Python 3.9", "def f(a: list[int]):"),
]


def number(since):
    return f"{since:.2f}"


def guarded(since, lines, at):
    """Whether the lines above ask for that version of CMake."""
    asked = [match.group(1) for line in lines[max(0, at - 45):at + 1]
             for match in re.finditer(r"CMAKE_VERSION VERSION_LESS (\d+\.\d+)", line)]
    return any(tuple(map(int, version.split("."))) >= tuple(map(int, number(since).split("."))) for version in asked)


def cmake(name, lines):
    for at, line in enumerate(lines):
        for pattern, since, _ in CMAKE:
            if re.search(pattern, line) and not line.lstrip().startswith("#") and not guarded(since, lines, at):
                yield f"{name}:{at + 1}: CMake {number(since)}: {line.strip()}"


def listed(name, lines, patterns):
    for at, line in enumerate(lines):
        for pattern, since, _ in patterns:
            if re.search(pattern, line):
                yield f"{name}:{at + 1}: {since}: {line.strip()}"


def fmt(name, lines):
    for at, line in enumerate(lines):
        for word in re.findall(r"\bfmt::(\w+)", line):
            if word not in FMT:
                yield f"{name}:{at + 1}: fmt::{word} is not in fmt 6.1: {line.strip()}"


def python(name, text):
    try:
        ast.parse(text, feature_version=(3, 8))
    except SyntaxError as error:
        yield f"{name}:{error.lineno}: no Python 3.8: {error.msg}"


for patterns in (CXX, CMAKE, SCRIPTS, PYTHON):
    for pattern, _, example in patterns:
        assert re.search(pattern, example), f"{pattern} does not find: {example}"

source, _ = tree.directories()
findings, read = [], 0
for name in tree.files(source):
    folder, extension = name.split("/")[0], os.path.splitext(name)[1]
    if folder == "third_party" or name == "test/build/old_versions_check.py":
        continue
    if extension not in (".h", ".cpp", ".cmake", ".md", ".py", ".pyi") and folder != "scripts" and not name.endswith("CMakeLists.txt"):
        continue
    with open(os.path.join(source, name), encoding="utf-8") as file:
        text = file.read()
    lines, read = text.split("\n"), read + 1
    if extension in (".h", ".cpp"):
        findings += [*listed(name, lines, CXX), *fmt(name, lines)]
    elif extension == ".cmake" or name.endswith("CMakeLists.txt"):
        findings += cmake(name, lines)
    elif extension in (".py", ".pyi"):
        findings += [*python(name, text), *([] if extension == ".pyi" else listed(name, lines, PYTHON))]
    if folder == "scripts" or extension == ".md":
        findings += listed(name, lines, SCRIPTS)
if read < 500:
    sys.exit(f"only {read} files were read: this check does not find the code")
tree.finish(findings, "newer than Ubuntu 20.04")
