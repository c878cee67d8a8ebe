"""Trials to the constants of an arm's laws."""
import json
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Union

from . import _softarm
from ._arm import Arm, handle_of
from ._common import Floats, Progress, jobs_of, number_of, number_or_none, pandas, progress_of, set_options, words_of
from ._trial import Trial, handles_of


class FittedConstant(NamedTuple):
    """A constant ``name`` after the fit, SI by ``unit``: ``initial``, that of the arm file, and ``value``.

    ``sd``: standard deviation from the trials alone; ``scale``: the size by which that is judged; ``determined``: well enough to use it;
    ``at_bound``: it ran into the limit of what an arm may have; ``kept``: the trials hardly mind, so it is the arm file's; ``advice``:
    what the trials lack, "" if determined.
    """

    name: str
    unit: str
    initial: float
    value: float
    sd: float
    scale: float
    determined: bool
    at_bound: bool
    kept: bool
    advice: str


class Identification:
    """What :func:`identify` found.

    ``arm``: the arm with the constants and the prior (its file as ``softarm identify --out`` writes it); ``verdict``: whether
    they are better on unseen trials, in one line; ``generalises``: the same as bool, None where there are none;
    ``constants``; ``correlation`` and ``covariance`` (k, k) of them, in their order and units; ``text``: tables for people.
    """

    def __init__(self, raw: Dict[str, Any]) -> None:
        self.arm = Arm(raw["arm"])
        self.verdict: str = raw["verdict"]
        self.generalises: Optional[bool] = raw["generalises"]
        self.constants: List[FittedConstant] = [FittedConstant(**one) for one in raw["constants"]]
        self.correlation: Floats = raw["correlation"]
        self.covariance: Floats = raw["covariance"]
        self.text: str = raw["text"]
        self._json: str = raw["json"]

    def __repr__(self) -> str:
        return f"<softarm.Identification {self.arm.name}: {self.verdict}>"

    def to_dict(self) -> Dict[str, Any]:
        """What ``softarm identify --json`` writes: constants, errors before and after by trial, what was left out."""
        found: Dict[str, Any] = json.loads(self._json)
        return found

    def to_pandas(self) -> Any:
        """A DataFrame of the constants, indexed by name."""
        return pandas().DataFrame([one._asdict() for one in self.constants], columns=FittedConstant._fields).set_index("name")


def identify(arm: Arm, trials: Sequence[Trial], *, free: Union[str, Sequence[str]] = (),
             also_free: Union[str, Sequence[str]] = (), held: Union[str, Sequence[str]] = (),
             tied: Union[str, Sequence[str]] = (), held_out: Union[str, Sequence[str]] = (), held_out_share: float = 1.0 / 3.0,
             leave_one_out: bool = False, seed: int = 0, frames_per_trial: int = 40, moving: bool = False, robust: bool = True,
             exact_inputs: bool = False, payload_kg: Optional[float] = None, jobs: int = 0,
             progress: Optional[Progress] = None) -> Identification:
    """Fits the constants of ``arm`` to ``trials``; as ``softarm identify``, whose options these are.

    ``free``, ``also_free``, ``held``, ``tied``: patterns of constants' names ("*.moment_gain"); tied ones have one value in all
    segments. ``held_out``: names of unseen trials: compared, not fitted; else the share ``held_out_share`` (0 to 0.9) of three or
    more, every n-th, or drawn by ``seed`` if that is not 0. ``leave_one_out``: all are fitted, and each is predicted from a fit to the
    others. ``frames_per_trial``: that are chosen of each; ``moving``: also where the arm moves; ``robust``: gross errors of bodies are
    bounded; ``exact_inputs``: inputs without noise and zeros of their sensors. ``payload_kg``: counts in all trials, whatever they
    recorded. ``jobs``: threads, 0: one per processor; ``progress``: called with (share done, what is being done).
    Effects of the arm file are held at their values.
    Raises IdentifyError for trials that nothing can be fitted to, ValueError for patterns and names that match nothing.
    """
    options = _softarm.IdentifyOptions()
    for name, value in (("free", free), ("also_free", also_free), ("held", held), ("tied", tied), ("held_out", held_out)):
        setattr(options, name, words_of(name, value))
    set_options(options, dict(held_out_share=number_of("held_out_share", held_out_share, 0.0, 0.9), leave_one_out=leave_one_out, seed=seed, frames_per_trial=frames_per_trial,
                              prefer_static=not moving, robust=robust, exact_inputs=exact_inputs))
    return Identification(_softarm.identify(handle_of(arm), handles_of(trials), number_or_none("payload_kg", payload_kg), options,
                                            jobs_of(jobs), progress_of(progress)))
