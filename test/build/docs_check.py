#!/usr/bin/python3
"""What the pages say of the tree is so: links, paths, constants of the code, the plan of the rooms, the glossary's
order, the map of the pages, fields of messages and parameters of nodes, the length of the README, the licence."""
import fnmatch
import os
import re
import subprocess
import sys
import urllib.parse

import tree

TOP = ("src", "include", "test", "scripts", "config", "doc", "launch", "msg", "srv", "cmake", "bench", "rviz", "python")
README_WORDS = 900
PARAMETERS = {"src/ros/node_params.cpp": "estimator_node", "src/apps/simulator_node.cpp": "simulator_node",
              "src/apps/diagnose_node/params.cpp": "diagnose_node"}
ROOMS = re.compile(r"<!-- rooms: generated -->\n(.*?)<!-- end -->\n", re.S)


def anchors(text):
    """Anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ +(.*)$", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M), re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\[(.*?)\]\(.*?\)", r"\1", heading).lower()).replace(" ", "-")
            for heading in headings}


def links(name, text, pages, names):
    for target in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)):
        path, _, anchor = urllib.parse.unquote(target).partition("#")
        if re.match(r"[a-z]+:", path):
            continue
        path = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
        if path not in names and not any(other.startswith(path + "/") for other in names):
            yield f"{name}: link to {target}: no such file"
        elif anchor and path in pages and anchor not in anchors(pages[path]):
            yield f"{name}: link to {target}: no such heading"


def paths(name, text, names):
    """Paths of the tree in code marks: `src/rod/rod.cpp`, `test/build/*_check.py`, `src/rod/`."""
    for path in re.findall(r"`((?:%s)/[\w./*-]+)`" % "|".join(TOP), text):
        if not any(other.startswith(path.rstrip("/") + "/") for other in names) and not fnmatch.filter(names, path):
            yield f"{name}: `{path}`: not in the tree"


def constants(name, text, code):
    for constant in set(re.findall(r"`(k[A-Z]\w+)`", text)):
        if not re.search(rf"\b{constant}\b", code):
            yield f"{name}: `{constant}`: no such constant in the code"


def rooms(pages, source):
    printed = subprocess.run([sys.executable, os.path.join(source, "test/build/rooms_check.py"), "--picture"],
                             stdout=subprocess.PIPE, encoding="utf-8", check=True).stdout
    page = pages["doc/architecture.md"]
    found = ROOMS.search(page)
    if not found or found.group(1) != printed:
        yield "doc/architecture.md: between its marks must stand what test/build/rooms_check.py --picture prints"
    described = re.findall(r"^\| `(\w+)` \|", page[:found.start()] if found else page, re.M)
    if described != re.findall(r"^\| `(\w+)` \|", printed, re.M):
        yield "doc/architecture.md: its table of rooms and the plan have different rooms, or another order"


def glossary(pages):
    terms = re.findall(r"^\| (?!term \|)(?!-)([^|]+?) \|", pages["doc/glossary.md"], re.M)
    if len(terms) < 10:
        yield "doc/glossary.md: no table of terms"
    ordered = sorted(terms, key=str.casefold)
    for term, expected in zip(terms, ordered):
        if term != expected:
            yield f"doc/glossary.md: '{term}' stands where '{expected}' should"
            break


def readme(pages):
    words = len(pages["README.md"].split())
    if words > README_WORDS:
        yield f"README.md: {words} words, allowed are {README_WORDS}"
    for name in sorted(pages):
        if re.fullmatch(r"doc/(?!README)[^/]+\.md", name) and f"]({name[4:]})" not in pages["doc/README.md"]:
            yield f"doc/README.md: the map has no line for {name}"


def section(page, title):
    """What stands under a heading of the second level, to the next one."""
    found = re.search(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", page, re.M | re.S)
    return found.group(1) if found else ""


def messages(page, texts):
    """Every field of the messages and services, and every parameter of the nodes, has its place in doc/messages.md."""
    asked = []
    for name, text in texts.items():
        title = os.path.splitext(os.path.basename(name))[0]
        if name.startswith(("msg/", "srv/")) and not re.match("# As ", text):  # those mirror a driver's
            asked += [(title, field) for field in re.findall(r"^(?!#)\S+ +(\w+)", text, re.M)]
        elif name in PARAMETERS:
            asked += [(f"Parameters of {PARAMETERS[name]}", parameter)
                      for parameter in re.findall(r'(?:reader\.(?:word|flag|number)|\bparam(?:<[\w:]+>)?)\("(\w+)"', text)]
    for title, word in asked:
        cells = ".*" if word.isupper() else "[^|]*"  # a constant stands in the row of its field
        if not re.search(rf"^\|{cells}`{word}`", section(page, title), re.M):
            yield f"doc/messages.md: under '{title}' there is no row of `{word}`"
    if len(asked) < 90:
        yield f"doc/messages.md: only {len(asked)} fields and parameters were looked for"


source, _ = tree.directories()
names = tree.files(source)
pages, texts, code = {}, {}, ""
for name in names:
    if name.endswith((".md", ".h", ".cpp", ".msg", ".srv")):
        with open(os.path.join(source, name), encoding="utf-8") as content:
            if name.endswith(".md"):
                pages[name] = content.read()
            elif name.startswith(("src/", "include/")):
                texts[name] = content.read()
                code += texts[name]
            elif name.endswith((".msg", ".srv")):
                texts[name] = content.read()
def licence(source):
    """One licence: its text, and its SPDX name wherever it is named."""
    def found(path, pattern):
        with open(os.path.join(source, path), encoding="utf-8") as text:
            match = re.search(pattern, text.read(), re.M)
        return match.group(1).replace(" License", "").replace(" ", "-") if match else "nothing"

    told = {"LICENSE": found("LICENSE", r"\A(.*)$"),
            "package.xml": found("package.xml", r"<license>(.*)</license>"),
            "CITATION.cff": found("CITATION.cff", r"^license: (.*)$"), "README.md": found("README.md", r"^(\S+) \(\[LICENSE\]")}
    return [f"{path}: its licence is {name}, that of LICENSE {told['LICENSE']}" for path, name in told.items()
            if name != told["LICENSE"]]


findings = [*licence(source), *rooms(pages, source), *glossary(pages), *readme(pages), *messages(pages["doc/messages.md"], texts)]
findings += [f"{name}: not there, so its parameters are not looked for" for name in PARAMETERS if name not in texts]
for name, text in sorted(pages.items()):
    findings += [*links(name, text, pages, names), *paths(name, text, names), *constants(name, text, code)]
tree.finish(findings, "pages against the tree")
