"""What the parts of the proof share: running programs, JSON files that are never half written, progress."""
import json
import os
import subprocess
import sys
import time


class NotDrawn(Exception):
    """A case that cannot be made; the proof goes on without it and says why. rejected: why each draw of it did not do."""
    def __init__(self, why, rejected=()):
        super().__init__(why)
        self.rejected = list(rejected)


def say(text):
    print(text, file=sys.stderr, flush=True)


def run(command, log):
    """Runs a program; returns its status and what it cost: seconds, those of all cores, peak memory in bytes."""
    started = time.monotonic()
    with open(log, "w", encoding="utf-8") as text:
        process = subprocess.Popen([str(word) for word in command], stdout=text, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, {"seconds": time.monotonic() - started, "core_seconds": usage.ru_utime + usage.ru_stime,
                                "memory_bytes": 1024 * usage.ru_maxrss}


def lines_of(path):
    with open(path, encoding="utf-8", errors="replace") as text:
        return [line.strip() for line in text.read().replace("\r", "\n").splitlines() if line.strip()]


def last_line(path):
    lines = lines_of(path)
    return lines[-1] if lines else "no message"


def read_json(path):
    with open(path, encoding="utf-8") as text:
        return json.load(text)


def write_json(path, value):
    """Beside and renamed: never half a file."""
    with open(path + ".part", "w", encoding="utf-8") as text:
        json.dump(value, text, indent=1)
        text.write("\n")
    os.replace(path + ".part", path)


def each(what, todo, action):
    """Does what is left of something, with progress and how long the rest will take."""
    started = time.monotonic()
    for done, item in enumerate(todo):
        left = (time.monotonic() - started) / done * (len(todo) - done) if done else None
        say(f"{what} {item} ({done + 1} of {len(todo)}" + (f", {left / 60:.0f} min left)" if left else ")"))
        action(item)


def jobs(options):
    """Words that say how many threads a program may have."""
    return ["--jobs", str(options.jobs)] if options.jobs else []
