"""What is wrong with recordings."""
import json
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Tuple, Union

from . import _softarm
from ._arm import Arm, handle_of
from ._common import Path, Progress, jobs_of, pandas, paths_of, progress_of


class Finding(NamedTuple):
    """One thing that is wrong with a recording, or worth knowing of it (doc/check.md lists all).

    ``recording``: its bag, "" for what all say together; ``severity``: "information", "warning", "serious"; ``id``: stable, for
    programs; ``where``: body, input or topic; ``what``: a sentence; ``spans_s``: (from, to) in s since its first sample, none where
    it is so throughout; ``figure``, ``figure_sd``: its size and standard deviation in ``unit`` (SI), None where there is none;
    ``remedy``; ``setting``: key and value that repair it.
    """

    recording: str
    severity: str
    id: str
    where: str
    what: str
    spans_s: Tuple[Tuple[float, float], ...]
    figure: Optional[float]
    figure_sd: Optional[float]
    unit: str
    remedy: str
    setting: str


def _finding(recording: str, one: Dict[str, Any]) -> Finding:
    return Finding(recording, one["severity"], one["id"], one["where"], one["what"],
                   tuple((begin, end) for begin, end in one["spans_s"]), one.get("figure"), one.get("figure_sd"),
                   one.get("unit", ""), one.get("remedy", ""), one.get("setting", ""))


class Check:
    """What :func:`check` found.

    ``findings``: of all recordings, in the order of the bags, the most serious of each first; ``together``: what several say
    together; ``worst``: of each recording by its bag, "serious", "warning", "information" or "none"; ``serious``: whether something
    spoils estimates (the program's exit status 1); ``text``: what the program prints.
    """

    def __init__(self, handle: "_softarm.CheckHandle") -> None:
        self._handle = handle
        self.text: str = handle.text(True)
        found = self.to_dict()
        self.findings: List[Finding] = [_finding(one["name"], finding) for one in found["recordings"] for finding in one["findings"]]
        self.together: List[Finding] = [_finding("", finding) for finding in found.get("together", [])]
        self.worst: Dict[str, str] = {one["name"]: one["worst"] for one in found["recordings"]}
        self.serious: bool = "serious" in self.worst.values()

    def __repr__(self) -> str:
        counts = [f"{sum(one.severity == word for one in self.findings)} {word}" for word in ("serious", "warning", "information")]
        return f"<softarm.Check of {len(self.worst)} recordings: {', '.join(counts)}>"

    def to_dict(self) -> Dict[str, Any]:
        """What ``softarm check --json`` writes: recordings with their streams (rates in Hz, noise) and findings."""
        found: Dict[str, Any] = json.loads(self._handle.json())
        return found

    def to_pandas(self) -> Any:
        """A DataFrame with a row per finding, those of all recordings together last."""
        return pandas().DataFrame([one._asdict() for one in self.findings + self.together], columns=Finding._fields)


def check(arm: Arm, paths: Union[Path, Iterable[Path]], *, jobs: int = 0, progress: Optional[Progress] = None) -> Check:
    """Says what is wrong with bags, and the remedy: units, frames, clocks, lost bodies, dead inputs ...; as ``softarm check``.

    ``paths``: one bag or several; ``jobs``: bags at a time, 0: one per processor; ``progress``: called with (share done, what is
    being done). A damaged bag is a finding. Raises BagError for a bag that is not there, ValueError where the arm file names a type
    that is not read.
    """
    return Check(_softarm.check_bags(handle_of(arm), paths_of(paths), jobs_of(jobs), progress_of(progress)))
