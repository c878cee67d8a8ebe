"""What the parts of the proof share: running programs, files that are never half written, tables, progress."""
import concurrent.futures
import contextlib
import fcntl
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


def markdown(lines):
    """A table of rows of cells, the headings first."""
    def row(cells):
        return "| " + " | ".join(str(cell).replace("|", "/").replace("\n", " ") for cell in cells) + " |"

    return "\n".join([row(lines[0]), "|" + "---|" * len(lines[0])] + [row(line) for line in lines[1:]])


def write_text(path, text):
    """Beside and renamed: never half a file."""
    with open(path + ".part", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".part", path)


def write_json(path, value):
    write_text(path, json.dumps(value, indent=1) + "\n")


def each(what, todo, action, at_once):
    """Does what is left of something, so many at once, with progress and how long the rest will take."""
    started = time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(at_once) as pool:
        running = {pool.submit(action, item): item for item in todo}
        try:
            for done, ended in enumerate(concurrent.futures.as_completed(running), 1):
                ended.result()
                left = (time.monotonic() - started) / done * (len(todo) - done)
                say(f"{what} {running[ended]} ({done} of {len(todo)}, {left / 60:.0f} min left)")
        finally:
            for one in running:  # after a failure; the pool waits for those that have begun
                one.cancel()


@contextlib.contextmanager
def alone(path):
    """While a file or folder that several cases share is made: no other thread or process is at it."""
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path + ".lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def jobs(options):
    """Words that say how many threads a program may have."""
    return ["--jobs", str(options.threads)]
