"""Trials to what an arm file leaves out."""
import datetime
import json
import os
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from . import _softarm
from ._arm import Arm, handle_of, write_text
from ._common import (Path, Progress, folders, jobs_of, number_of, number_or_none, pandas, path_of, progress_of, set_options, whole_of,
                      words_of)
from ._trial import Trial, handles_of


class Diagnosis:
    """What :func:`diagnose` found.

    ``verdict``: "consistent", "explained", "partly_explained", "unknown" or "cannot_tell"; ``summary``: the same in a sentence
    or two; ``effects``: what the verdict stands on, best first, and ``ranking``: every effect of the catalogue, each a dict as in
    ``report.json``; ``text``: for people; ``extended_arm``: the arm with the effects in it, None where its file cannot be edited.
    """

    def __init__(self, handle: "_softarm.DiagnosisHandle") -> None:
        self._handle = handle
        self._origin: Tuple[str, str, List[Tuple[str, str]]] = ("", datetime.datetime.utcnow().strftime("%Y-%m-%dT%H:%MZ"), [])
        self.text: str = handle.text()
        self.extended_arm: Optional[Arm] = None if handle.extended is None else Arm(handle.extended)
        found = self.to_dict()
        self.verdict: str = found["verdict"]
        self.summary: str = found.get("summary", "")
        self.effects: List[Dict[str, Any]] = found["effects"]
        self.ranking: List[Dict[str, Any]] = found["ranking"]

    def __repr__(self) -> str:
        names = ", ".join(effect["name"] for effect in self.effects)
        return f"<softarm.Diagnosis {self.verdict}{': ' if names else ''}{names}>"

    def to_dict(self) -> Dict[str, Any]:
        """``report.json`` (doc/diagnose.md)."""
        found: Dict[str, Any] = json.loads(self._handle.json(*self._origin))
        return found

    def to_pandas(self) -> Any:
        """A DataFrame of ``ranking``, indexed by the effects' names."""
        return pandas().DataFrame(self.ranking).set_index("name")

    def save(self, folder: Path, *, force: bool = False) -> List[str]:
        """Writes report.html, report.json and arm_extended.yaml into a ``folder``, which is made where it is missing.

        Returns their paths. Raises FileExistsError where one is there, unless ``force``; Error where the page's files were not
        installed.
        """
        folder = path_of("folder", folder)
        files = {"report.html": self._handle.html(folders("report"), *self._origin),
                 "report.json": self._handle.json(*self._origin)}
        if self.extended_arm is not None:
            files["arm_extended.yaml"] = self.extended_arm.text
        os.makedirs(folder, exist_ok=True)
        paths = [os.path.join(folder, name) for name in files]
        for path in paths:
            if not force and os.path.exists(path):
                raise FileExistsError(f"{path}: exists; force=True replaces it")
        for path, text in zip(paths, files.values()):
            write_text(path, text, True)
        return paths


def diagnose(arm: Arm, trials: Sequence[Trial], *, held: Union[str, Sequence[str]] = (), tied: Union[str, Sequence[str]] = (),
             block_s: float = 0.2, most_effects: int = 8, payload_kg: Optional[float] = None, jobs: int = 0,
             progress: Optional[Progress] = None) -> Diagnosis:
    """Finds what physics ``arm`` leaves out, where and how large, from three or more ``trials``; as ``softarm diagnose``.

    ``held``, ``tied``: patterns of constants, as of :func:`identify`; ``block_s``: time over which frames are averaged, s, 0.02 to 2;
    ``most_effects``: in one verdict, 1 to 8, more than 4 only where much is left, or another is certain; ``payload_kg``: counts in all
    trials, whatever they recorded; ``jobs``: threads, 0: one per processor. It takes from seconds to minutes; ``progress`` is told
    (share done, what is being done), and Ctrl-C ends it.
    Raises IdentifyError for trials that cannot be used, ValueError for patterns that match nothing.
    """
    options = _softarm.DiagnoseOptions()
    options.held, options.tied = words_of("held", held), words_of("tied", tied)
    set_options(options, dict(block_s=number_of("block_s", block_s, 0.02, 2.0, " s"),
                              most_effects=whole_of("most_effects", most_effects, 1, 8), jobs=jobs_of(jobs)))
    return Diagnosis(_softarm.diagnose(handle_of(arm), handles_of(trials), number_or_none("payload_kg", payload_kg), options,
                                       progress_of(progress)))


def catalogue() -> List[Dict[str, Any]]:
    """Every effect that :func:`diagnose` looks for: id, description, law, source, rivals, parameters with unit and range."""
    return _softarm.catalogue()
