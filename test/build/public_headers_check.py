#!/usr/bin/python3
"""The public headers include each other, Eigen and the standard library alone, and what they declare is exported."""
import os
import re
import sys

import tree

source, _ = tree.directories()
names = [name for name in tree.files(source) if name.startswith("include/")]
if not names:
    sys.exit("no public header found")
findings = []
for name in names:
    with open(os.path.join(source, name), encoding="utf-8") as file:
        text = file.read()
    if "#pragma once" not in text:
        findings.append(f"{name}: no #pragma once")
    for given in re.findall(r'^#\s*include\s*"(.+?)"', text, re.M):
        if "include/" + given not in names:
            findings.append(f"{name}: includes {given}, which is private")
    for given in re.findall(r"^#\s*include\s*<(.+?)>", text, re.M):
        if not re.fullmatch(r"Eigen/\w+|[a-z_]+", given):
            findings.append(f"{name}: includes <{given}>: only Eigen and the standard library are what users must have")
    # Functions at the level of the namespace, and types with functions: declared here, defined in the library.
    code = re.sub(r"//.*", "", text)
    for declared in re.findall(r"^(?!using|inline|constexpr|template|#|\}|namespace)(\w[^;{}]*\([^;{}]*\));", code, re.M):
        if not declared.startswith("SOFTARM_EXPORT"):
            findings.append(f"{name}: {' '.join(declared.split())} is not exported")
    for kind, body in re.findall(r"^((?:class|struct)[^;{]*)\{(.*?)^\};", code, re.M | re.S):
        members = re.sub(r"=[^;]*;", ";", body)  # initial values are no functions
        members = re.sub(r"\{[^{}]*\}", "", members)  # nor is what is called in a body that is given here
        if "SOFTARM_EXPORT" not in kind and ("runtime_error" in kind or re.search(r"\)\s*(const|noexcept)?\s*;", members)):
            findings.append(f"{name}: {' '.join(kind.split())} has functions in the library, or is thrown: not exported")
tree.finish(findings, "public headers")
