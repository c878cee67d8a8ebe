#!/usr/bin/python3
"""Bags with flipped, cut and zeroed bytes and false lengths, offsets and counts: every program reads them or refuses them in
one line. None is killed by a signal, hangs, takes much memory or leaves files behind.

As a test it takes some seconds. For more, or to see one case again:

    test/build/damaged_bags_check.py SOURCE BUILD --cases 10000 [--first N] [--programs check,estimate,identify,diagnose]
"""
import argparse
import collections
import concurrent.futures
import os
import random
import re
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile

import tree

CASES = 400
LIMIT_S = collections.defaultdict(lambda: 20, diagnose=300)  # a bag that can be read is diagnosed
MOST_MEMORY = 1 << 30
PROGRAMS = {"check": "check --quiet --arm online_200mm {bag}",
            "estimate": "estimate --arm online_200mm {bag} --force --out {out}/e",
            "identify": "identify --arm online_200mm {bag} --force --out {out}/i.yaml",
            "diagnose": "diagnose --arm online_200mm {bag} --force --out {out}/d"}
# What a number that is read as a length, an offset or a count is replaced by; the last is the number that it was.
FALSE = [lambda r, n: 0, lambda r, n: 0xFFFFFFFF, lambda r, n: 0x7FFFFFFF, lambda r, n: 0x80000000, lambda r, n: n + 1,
         lambda r, n: max(n - 1, 0), lambda r, n: r.randrange(1 << 32), lambda r, n: r.randrange(1 << 20),
         lambda r, n: r.randrange(4096)]

Region = collections.namedtuple("Region", "kind begin end")
Number = collections.namedtuple("Number", "kind at size")


def record(data, at):
    """(fields: name to (begin, end) of its value; begin and end of the data; numbers that are lengths) of a record."""
    numbers = [Number("header_len", at, 4)]
    end = at + 4 + struct.unpack_from("<I", data, at)[0]
    at += 4
    fields = {}
    while at < end:
        numbers.append(Number("field_len", at, 4))
        stop = at + 4 + struct.unpack_from("<I", data, at)[0]
        equals = data.index(b"=", at + 4, stop)
        fields[data[at + 4:equals].decode()] = (equals + 1, stop)
        at = stop
    numbers.append(Number("data_len", at, 4))
    return fields, at + 4, at + 4 + struct.unpack_from("<I", data, at)[0], numbers


def anatomy(data):
    """The regions of a bag and the numbers in it that a reader follows."""
    names = {3: "bag_header", 4: "index", 5: "chunk", 6: "chunk_info", 7: "connection", 2: "message"}
    regions, numbers, at = [Region("magic", 0, 13)], [], 13
    while at < len(data):
        fields, begin, end, found = record(data, at)
        kind = names[data[fields["op"][0]]]
        regions += [Region(kind + "_header", at, begin), Region(kind + "_data", begin, max(end, begin + 1))]
        numbers += found
        numbers += [Number(name, value[0], value[1] - value[0]) for name, value in fields.items()
                    if value[1] - value[0] in (4, 8) and name not in ("type", "topic")]
        if kind == "index":
            numbers += [Number("index_offset", i + 8, 4) for i in range(begin, end, 12)]
        elif kind == "chunk_info":
            numbers += [Number("chunk_info_word", i, 4) for i in range(begin, end, 4)]
        elif kind == "chunk" and data[slice(*fields["compression"])] == b"none":
            inside = begin
            while inside < end:
                _, _, inside, found = record(data, inside)
                numbers += [n._replace(kind="in_chunk_" + n.kind) for n in found]
        at = end
    return regions, numbers


def damaged(data, regions, numbers, seed):
    """A damaged copy of a bag, and what was done to it."""
    r = random.Random(seed)
    data = bytearray(data)
    done = []
    kinds = sorted({region.kind for region in regions})
    number_kinds = sorted({number.kind for number in numbers})
    for _ in range(r.choice([1, 1, 1, 2, 4])):
        what = r.choice(["flip", "cut", "zero", "false", "false", "false"])
        if what == "false":  # each kind as often as the others, however many there are of it
            kind = r.choice(number_kinds)
            number = r.choice([n for n in numbers if n.kind == kind])
            layout = "<I" if number.size == 4 else "<Q"
            old = struct.unpack_from(layout, data, number.at)[0]
            new = r.choice(FALSE)(r, old) % (1 << (8 * number.size))
            struct.pack_into(layout, data, number.at, new)
            done.append(f"{kind} at {number.at}: {old} -> {new}")
            continue
        kind = r.choice(kinds)
        region = r.choice([x for x in regions if x.kind == kind])
        at = r.randrange(region.begin, region.end)
        count = r.choice([1, 1, 4, 16, 64])
        if what == "flip":
            for i in range(at, min(at + count, len(data))):
                data[i] ^= 1 << r.randrange(8)
        elif what == "zero":
            data[at:at + count] = bytes(min(count, len(data) - at))
        elif r.random() < 0.3:
            del data[at:]
        else:
            del data[at:at + count]
        done.append(f"{what} of {count} at {at} in {kind}")
        if what == "cut":  # what follows is elsewhere now
            break
    return bytes(data), "; ".join(done)


def originals(softarm, folder):
    """Small bags of the virtual rig: as it records, and with each compression in several chunks."""
    import rosbag
    recorded = os.path.join(folder, "lz4.bag")
    subprocess.run([softarm, "simulate", "demo", "--seconds", "2", "--seed", "3", "--out", recorded], check=True,
                   stdout=subprocess.DEVNULL)
    paths = [recorded]
    for compression in ("none", "bz2"):
        paths.append(os.path.join(folder, compression + ".bag"))
        with rosbag.Bag(recorded) as old, rosbag.Bag(paths[-1], "w", compression, 30000) as new:
            for topic, message, stamp in old.read_messages(raw=True):
                new.write(topic, message, stamp, raw=True)
    bags = []
    for path in paths:
        with open(path, "rb") as file:
            bags.append((os.path.basename(path), file.read()))
    return [(name, data, *anatomy(data)) for name, data in bags]


def limit():
    if not os.environ.get("SOFTARM_SANITIZE"):  # a sanitizer takes terabytes of addresses
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def judged(name, command, folder, before):
    """What is wrong with one run; empty where nothing is, and the word for its kind of end."""
    try:
        run = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, check=False,
                             timeout=LIMIT_S[name], preexec_fn=limit, encoding="utf-8", errors="replace")
    except subprocess.TimeoutExpired:
        return f"still running after {LIMIT_S[name]} s", "hung"
    left = sorted(set(os.listdir(folder)) - before)
    if run.returncode < 0:
        return f"killed by {signal.Signals(-run.returncode).name}", "killed"
    if re.search(r"bad_alloc|terminate called|Assertion|length_error|Sanitizer|runtime error:", run.stdout + run.stderr):
        return f"says {run.stdout + run.stderr!r}", "unclear"
    if run.returncode == 0:
        return "", "read"
    said = [line for line in run.stderr.splitlines() if line.startswith("softarm: ")]
    if name == "check":
        refused = re.search("was cut off|damaged|cannot be read|no bag of format|is encrypted", run.stdout)
        return ("", "refused" if refused else "found") if run.stdout and not run.stderr else \
            (f"exit {run.returncode}, says {run.stdout!r} {run.stderr!r}", "unclear")
    if len(said) != 1:
        return f"exit {run.returncode}, says {run.stderr!r}", "unclear"
    return (f"leaves {left}", "litter") if left else ("", "refused")


def one_case(softarm, bags, programs, seed, folder):
    """(findings, words for the ends) of the programs on one damaged bag."""
    name, data, regions, numbers = bags[seed % len(bags)]
    changed, done = damaged(data, regions, numbers, seed)
    work = tempfile.mkdtemp(dir=folder)
    bag = os.path.join(work, "a.bag")
    with open(bag, "wb") as file:
        file.write(changed)
    findings, ends = [], []
    for program in programs:
        command = [softarm, *PROGRAMS[program].format(bag=bag, out=work).split()]
        problem, end = judged(program, command, work, set(os.listdir(work)))
        ends.append((program, end))
        if problem:
            findings.append(f"case {seed} ({name}: {done}): {program} {problem}")
    shutil.rmtree(work)
    return findings, ends


def main():
    source, build = tree.directories()
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("source")
    options.add_argument("build")
    options.add_argument("--cases", type=int, default=int(os.environ.get("SOFTARM_FUZZ_CASES", CASES)))
    options.add_argument("--first", type=int, default=0, help="number of the first case")
    options.add_argument("--programs", default="", help="default: check, and estimate in every fourth case")
    options.add_argument("--jobs", type=int, default=2)
    given = options.parse_args()
    softarm = os.path.join(build, "devel/lib/softarm_estimator/softarm")
    if not os.path.exists(softarm):
        tree.skip("built without ROS")
    folder = tempfile.mkdtemp(prefix="damaged_bags_", dir=build)
    try:
        bags = originals(softarm, folder)
        chosen = lambda seed: given.programs.split(",") if given.programs else \
            ["check", "estimate"] if seed % 4 == 0 else ["check"]
        with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
            done = list(pool.map(lambda seed: one_case(softarm, bags, chosen(seed), seed, folder),
                                 range(given.first, given.first + given.cases)))
    finally:
        shutil.rmtree(folder)
    for (program, end), count in sorted(collections.Counter(e for _, ends in done for e in ends).items()):
        print(f"{program}: {end} {count}")
    tree.finish([finding for findings, _ in done for finding in findings], f"damaged bags ({given.cases})")


if __name__ == "__main__":
    main()
