#!/usr/bin/python3
"""Functions are read in one look: none of src/ is longer than LIMIT lines; the longest ones are printed.

Left out are the rig, whose lists of what can be hidden are one function each, and the papers' equations.
"""
import os
import re
import sys

import tree

LIMIT = 65
SHOWN = 10
LEFT_OUT = ("src/rig/", "src/published/")
NO_FUNCTION = re.compile(r"\s*(namespace|class|struct|enum|union|extern|using|static_assert|if|for|while|switch|else|do|case|"
                         r"return|public|private|protected|template|#|/|\})\b|\s*[#/}]")


def name_of(head):
    head = re.sub(r"__attribute__\(\(\w+\)\)", "", head)
    found = re.search(r"(operator\S+|[\w~]+)\s*\($", head[:head.index("(") + 1])
    return found.group(1) if found else head.split("(")[0].strip()


def functions(lines):
    """(name, first line, number of lines) of each, as clang-format lays them out: the head begins, and the last brace
    stands, in the first column, or in the third for members that are defined in their class."""
    inside = set()  # lines of functions that are not defined in a class
    for indent in ("", "  "):
        at = 0
        while at < len(lines):
            line = lines[at]
            starts = at not in inside and line.startswith(indent) and len(line) > len(indent) and not line[len(indent)].isspace()
            if not starts or NO_FUNCTION.match(line):
                at += 1
                continue
            end = at
            while end + 1 < len(lines) and not re.search(r"[;{}]\s*(//.*)?$", lines[end]):
                end += 1
            head = " ".join(lines[at:end + 1])
            is_function = "(" in head and re.search(r"\{\s*(//.*)?$", head) and not re.search(r"=[^()]*\{\s*(//.*)?$", head)
            if not is_function:
                at = end + 1
                continue
            last = end + 1
            while last < len(lines) and not lines[last].startswith(indent + "}"):
                last += 1
            yield name_of(head), at + 1, last - at + 1
            inside.update(range(at, last + 1))
            at = last + 1


source, _ = tree.directories()
found = []
for path in tree.files(source):
    if path.startswith(("src/", "include/")) and path.endswith((".h", ".cpp")) and not path.startswith(LEFT_OUT):
        with open(os.path.join(source, path), encoding="utf-8") as text:
            found += [(length, path, line, name) for name, line, length in functions(text.read().split("\n"))]
if len(found) < 1000:
    sys.exit(f"only {len(found)} functions were found: this check does not read the code as it is laid out any more")
found.sort(reverse=True)
for length, path, line, name in found[:SHOWN]:
    print(f"  {length:3d} lines  {path}:{line}: {name}")
findings = [f"{path}:{line}: {name} has {length} lines, more than {LIMIT}"
            for length, path, line, name in found if length > LIMIT]
tree.finish(findings, f"functions of more than {LIMIT} lines")
