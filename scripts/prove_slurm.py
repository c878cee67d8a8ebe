"""Cases of the proof as arrays of Slurm: a task is the proof's own command, held to one case."""
import hashlib
import os
import shlex
import shutil
import subprocess
import sys
import time

from prove_files import say

MOST = 1000  # tasks of an array; Slurm's own limit is 1001 unless told otherwise
ASK_S, SAY_S = 5.0, 60.0


def ask(*words):
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8", check=False)
    return done.returncode, done.stdout, " ".join(done.stderr.split())


def array_name(folder, what):
    return f"prove_{hashlib.sha256(os.path.realpath(folder).encode()).hexdigest()[:12]}_{what}"


def in_queue(name):
    """States of its tasks that have not ended; nothing where Slurm does not answer."""
    status, lines, _ = ask("squeue", "--noheader", "--array", f"--name={name}", "--format=%t",
                           "--states=PENDING,CONFIGURING,RUNNING,COMPLETING,SUSPENDED,STOPPED,REQUEUED,REQUEUE_HOLD,SPECIAL_EXIT")
    return [line.strip() for line in lines.splitlines()] if status == 0 else None


def wait(name, what, is_done):
    said, asked = time.monotonic(), ASK_S / 5
    while True:
        states = in_queue(name)
        if states == []:
            return
        if states and time.monotonic() - said > SAY_S:
            said = time.monotonic()
            say(f"{what}: {is_done()} done, {states.count('R')} running, {states.count('PD')} waiting")
        time.sleep(asked)
        asked = min(ASK_S, 1.5 * asked)


def each(what, todo, command, folder, slurm_options, left):
    """Hands what is to do to Slurm, and waits. Cases that an earlier run has left in the queue are waited for first.

    command: the words that do one case, without its name; left(): the cases that are still to do."""
    for program in ("sbatch", "squeue", "scancel"):
        if shutil.which(program) is None:
            sys.exit(f"prove: --engine slurm: no {program} on PATH (Debian: slurm-client)")
    name = array_name(folder, what)
    if in_queue(name) is None:
        sys.exit("prove: --engine slurm: Slurm does not answer")
    whole = len(todo)
    try:
        if in_queue(name):
            say(f"{what}: cases of an earlier run are still in Slurm's queue; waiting for them")
            wait(name, what, lambda: whole - len(left()))
        todo = left()
        for begin in range(0, len(todo), MOST):
            submit(name, todo[begin:begin + MOST], command, folder, slurm_options, what)
        wait(name, what, lambda: whole - len(left()))
    except KeyboardInterrupt:
        ask("scancel", f"--name={name}")
        sys.exit("prove: interrupted; the same command goes on from here")
    missing = left()
    if missing:
        sys.exit(f"prove: {what}: Slurm has ended {len(missing)} of {whole} cases before they were done ({missing[0]}, "
                 f"...; logs in {os.path.join(folder, 'slurm')}); the same command goes on from here")


def submit(name, todo, command, folder, slurm_options, what):
    place = os.path.join(folder, "slurm")
    os.makedirs(place, exist_ok=True)
    number = 1
    while os.path.exists(os.path.join(place, f"{what}_{number}.sh")):
        number += 1
    script = os.path.join(place, f"{what}_{number}.sh")
    with open(script, "w", encoding="utf-8") as text:
        text.write("#!/bin/sh\nset -- " + " ".join(todo) + "\nshift \"$SLURM_ARRAY_TASK_ID\"\n"
                   f"exec {shlex.join(command)} --only \"{what}:$1\"\n")
    status, said, error = ask("sbatch", "--parsable", f"--array=0-{len(todo) - 1}", f"--job-name={name}", "--requeue",
                              f"--output={place}/{what}_{number}_%a.log", *slurm_options, script)
    if status != 0:
        sys.exit(f"prove: --engine slurm: sbatch took no case: {error}")
    say(f"{what}: {len(todo)} cases are array {said.strip().split(';')[0]} of Slurm")
