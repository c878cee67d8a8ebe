"""The record of a proof: one small file with what was drawn, sealed and decided so far, from which it goes on elsewhere. Recordings
are not in it: those of cases that are still to decide are made again by their truth (prove_sources.py: again)."""
import hashlib
import io
import json
import lzma
import os
import tarfile

from prove_files import read_json

PLAN = "truth/plan.json"
TRUTH = ("case.json", "displacement.json")  # of a case: its trials' own follow from the first
DECIDED = ("cost.json", "baselines.json", "displacement.json")
# What figures and pages read of a report, of its ranking, and of each effect that it names.
OF_REPORT = ("verdict", "noise_floor_m", "exchanged_names", "told_payloads", "shifts")
OF_MODEL = ("held_out_rms_m", "held_out_weighted_rms_m")
OF_LAW = ("share", "share_of_flexible")
OF_RANKING = ("name", "probability", "finding")
NAMED = ("effects", "small_departures", "stand_ins")
OF_NAMED = ("name", "probability", "confusable_with", "parameters", "where")


def some(keys, of):
    return {key: of[key] for key in keys if key in of}


def of_report(report):
    """A report with nothing but what the proof is scored by."""
    kept = some(OF_REPORT, report)
    law = report.get("discovered_law")
    kept["discovered_law"] = some(OF_LAW, law) if law else None
    for model in ("baseline", "extended"):
        kept[model] = some(OF_MODEL, report[model])
    kept["ranking"] = [some(OF_RANKING, one) for one in report["ranking"]]
    for key in NAMED:
        if key in report:
            kept[key] = [some(OF_NAMED, one) for one in report[key]]
    return kept


def read(path):
    with open(path, "rb") as data:
        return data.read()


def sums(folder):
    """SHA-256 of all files in a folder but SHA256SUMS, by their paths in it."""
    found = {}
    for parent, _, files in os.walk(folder):
        for name in files:
            path = os.path.join(parent, name)
            found[os.path.relpath(path, folder)] = hashlib.sha256(read(path)).hexdigest()
    return {path: found[path] for path in sorted(found) if path != "SHA256SUMS"}


def matches(found, listed):
    """Whether a truth's files are those of its SHA256SUMS. A record has none of the trials' own, and none that tells how a case was
    drawn: those may be absent, no other."""
    known = dict(reversed(line.split("  ", 1)) for line in listed.splitlines())
    return (all(known.get(path) == digest for path, digest in found.items())
            and all(path in found or path.endswith((".truth.yaml", ".log")) for path in known))


def contents(folder, decided):
    """(path in the folder, bytes) of what is kept; decided: names of the cases that are."""
    paths = ["seal.json"]
    for name in sorted(os.listdir(os.path.join(folder, "truth"))):
        if name.endswith((".part", ".log")):  # of a case that is being drawn
            continue
        own = os.path.join("truth", name)
        paths += [own] if os.path.isfile(os.path.join(folder, own)) else [os.path.join(own, file) for file in TRUTH]
    paths += [os.path.join("reports", case, file) for case in decided for file in DECIDED]
    kept = [(path, read(os.path.join(folder, path))) for path in paths if os.path.exists(os.path.join(folder, path))]
    for case in decided:
        path = os.path.join("reports", case, "report.json")
        if os.path.exists(os.path.join(folder, path)):
            kept.append((path, json.dumps(of_report(read_json(os.path.join(folder, path)))).encode()))
    return kept


def write(folder, decided, path):
    """The same folder gives the same bytes."""
    with tarfile.open(path + ".part", "w:xz") as archive:
        for name, data in contents(folder, decided):
            entry = tarfile.TarInfo(name)
            entry.size = len(data)
            archive.addfile(entry, io.BytesIO(data))
    os.replace(path + ".part", path)


def entries(path):
    """(path, bytes) of everything in a record; raises ValueError where it is none, or damaged."""
    try:
        with tarfile.open(path, "r:xz") as archive:
            found = [(os.path.normpath(entry.name), archive.extractfile(entry).read()) for entry in archive if entry.isfile()]
    except (OSError, EOFError, lzma.LZMAError, tarfile.TarError) as failed:
        raise ValueError(f"{path}: not the record of a proof: {failed}") from failed
    if PLAN not in (name for name, _ in found) or any(name.startswith(("/", "..")) for name, _ in found):
        raise ValueError(f"{path}: not the record of a proof")
    return found


def plan_of(found):
    return json.loads(dict(found)[PLAN])


def unpack(found, folder):
    """What the folder has already stays."""
    for name, data in found:
        target = os.path.join(folder, name)
        if not os.path.exists(target):
            os.makedirs(os.path.dirname(target), exist_ok=True)
            with open(target, "wb") as file:
                file.write(data)
