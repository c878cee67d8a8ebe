"""Trials of the virtual rig, made by the program: the rig shares no code with the model, nor with this package."""
import json
import os
import re
import subprocess
import tempfile
from typing import Any, Dict, List, Mapping, Optional, Tuple, Union

from . import _softarm
from ._arm import Arm
from ._common import Floats, Path, Progress, number_of, pandas, path_of, prefix, progress_of, whole_of, wrong
from ._tables import read_table


class Simulation:
    """A recorded trial of the virtual rig, and its truth (doc/rig.md).

    ``bag``: path of what the sensors saw, for :func:`read_bag`; ``truth_path``: of the truth's time series; ``truth``: its columns by
    name, (n,) arrays, SI as their names say, ``stamp`` in s; ``hidden``: what the scenario is and hides, as nested dicts;
    ``text``: what the program printed, digests of the truth among it.
    """

    def __init__(self, bag: str, truth_path: str, text: str) -> None:
        self.bag = bag
        self.truth_path = truth_path
        self.text = text
        self.truth: Dict[str, Floats] = read_table(truth_path, ["stamp"])
        with open(os.path.splitext(truth_path)[0] + ".yaml", encoding="utf-8") as file:
            self.hidden: Dict[str, Any] = _softarm.keys_of_yaml(file.read())

    def __repr__(self) -> str:
        return f"<softarm.Simulation {self.bag}: {len(self.truth['stamp'])} frames>"

    def to_dict(self) -> Dict[str, Any]:
        """``hidden``: the file trial.truth.yaml."""
        return self.hidden

    def to_pandas(self) -> Any:
        """A DataFrame of ``truth``, indexed by ``stamp`` (s)."""
        return pandas().DataFrame(self.truth).set_index("stamp")


def _scenario_file(scenario: Union[Path, Arm, Mapping[str, Any]], folder: str) -> str:
    """The name of a scenario, or the path of a file that holds it."""
    if isinstance(scenario, (str, os.PathLike)):
        return path_of("scenario", scenario)
    if isinstance(scenario, Arm):
        name, text = scenario.name, scenario.text
    elif isinstance(scenario, Mapping):
        try:
            name, text = "scenario", json.dumps(scenario)  # which is YAML
        except (TypeError, ValueError) as why:
            raise wrong("scenario", str(why), "numbers, texts, lists and dicts") from None
    else:
        raise wrong("scenario", scenario, "a name, a path, an Arm or a dict")
    path = os.path.join(folder, re.sub(r"[^\w.-]", "_", name) + ".yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def _run(arguments: List[str], progress: Optional[Progress]) -> Tuple[str, str]:
    """Standard output of the program, and the line with which it failed, "" where it did not."""
    program = os.path.join(prefix(), "lib", "softarm_estimator", "softarm")
    try:
        process = subprocess.Popen([program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    except OSError as why:
        raise _softarm.Error(f"{program}: {why.strerror}; simulate needs the program, which "
                             "scripts/softarm builds") from None
    assert process.stdout is not None and process.stderr is not None
    said = ""
    try:
        for line in process.stderr:
            share = re.match(r"\d+ s: (\d+) %", line)
            if not share:
                said = line.strip()
            elif progress is not None:
                progress(0.01 * int(share.group(1)), "simulating")
        text = process.stdout.read()
        process.wait()
    finally:
        if process.poll() is None:
            process.terminate()
            process.wait()
        process.stdout.close()
        process.stderr.close()
    if process.returncode == 0:
        return text, ""
    return text, said[len("softarm: "):] if said.startswith("softarm: ") else said or f"{program}: ended with {process.returncode}"


def simulate(scenario: Union[Path, Arm, Mapping[str, Any]], out: Path, *, seconds: Optional[float] = None,
             seed: Optional[int] = None, force: bool = False, progress: Optional[Progress] = None) -> Simulation:
    """Records a trial of the virtual rig as a bag, the truth sealed beside it; it is ``softarm simulate`` that does it.

    ``scenario``: a scenario's file, the name of one that ships ("demo"), its keys as a dict, or an arm (a file, or an :class:`Arm`,
    its effects in it), which then moves at random; ``out``: the bag; its truth is written beside it, as trial.truth.csv ...
    ``seconds``: of simulated time, from 0.01, instead of the scenario's; ``seed``: of all random numbers, 0 or more;
    ``force``: files that are there are replaced; ``progress``: called with (share done, what is being done) every ten seconds.

    Raises Error with the program's line for what is no scenario, for what the rig has no law of, and for files that are there;
    ValueError for an argument.
    """
    options: List[str] = []
    if seconds is not None:
        options += ["--seconds", repr(number_of("seconds", seconds, 0.01, 1e6))]
    if seed is not None:
        options += ["--seed", str(whole_of("seed", seed, 0, 2**64 - 1))]
    bag, progress = path_of("out", out), progress_of(progress)
    with tempfile.TemporaryDirectory(prefix="softarm_") as folder:
        file = _scenario_file(scenario, folder)
        text, failure = _run(["simulate", *options, *(["--force"] if force else []), "--out", bag, "--", file], progress)
        if failure:
            raise _softarm.Error(failure.replace(folder + os.sep, ""))
    return Simulation(bag, os.path.splitext(bag)[0] + ".truth.csv", text)
