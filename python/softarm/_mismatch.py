"""What the live monitor says: how far the arm is off its laws, and sudden changes."""
from typing import Any, Dict, List, NamedTuple

import numpy as np

from . import _softarm
from ._common import Bools, Floats, Words, pandas, plain_dict

_KINDS = np.array(_softarm.change_kinds())
_AXES = np.array(_softarm.mismatch_axes())


class Alarm(NamedTuple):
    """A sudden change. ``onset_s``, ``seen_s``: s from the first frame, when it began and was last seen; ``description``: one
    line with kind, place and size."""

    onset_s: float
    seen_s: float
    description: str


class Mismatch:
    """Does the arm do what its laws, and its own last minutes, say? The fields of the node's message ``Mismatch`` (doc/mismatch.md)
    at n frames.

    ``stamp_s`` (n,) s; ``valid`` (n,) bool: enough frames were seen, else the rest says nothing and floats are NaN; ``laws`` (n,)
    bool: the inputs are known.
    Against the arm's laws, (n,): ``score_sd``, in standard deviations of one frame's noise, and ``rms_m``, m per body.
    Against the last minutes, (n,): ``change_sd``, the likeliest sudden change in its standard deviations; ``threshold_sd``, beyond
    which it is an alarm if it lasts, 0 while alarms are held off; ``alarm`` bool; ``onset_s``, stamp at which the alarm's cause
    began, s; ``kind`` and ``or_kind`` (as likely, or "none"): "none", "ring", "contact", "actuation", "base", "unclear";
    ``size_m``, the largest displacement of a body by it, m.
    Where, (n,): ``s_m``, ``s_from_m``, ``s_to_m``, m from the base at zero input; ``body``, at or next to that, "" for none;
    ``axis``: "in_plane", "out_of_plane", "axial", "" for none. ``description``: one line per frame.
    """

    def __init__(self, raw: Dict[str, Any], stamp_s: Floats, body_names: List[str]) -> None:
        self.stamp_s = stamp_s
        self.kind = _KINDS[raw.pop("kind_code")]
        self.or_kind = _KINDS[raw.pop("or_kind_code")]
        self.axis = _AXES[raw.pop("axis_code")]
        self.body = np.array(body_names + [""])[raw.pop("body_index")]
        self.description: List[str] = raw.pop("description")
        for name, array in raw.items():
            setattr(self, name, array.astype(bool) if name in ("valid", "laws", "alarm") else array)

    stamp_s: Floats
    valid: Bools
    laws: Bools
    score_sd: Floats
    rms_m: Floats
    change_sd: Floats
    threshold_sd: Floats
    alarm: Bools
    onset_s: Floats
    kind: Words
    or_kind: Words
    size_m: Floats
    s_m: Floats
    s_from_m: Floats
    s_to_m: Floats
    body: Words
    axis: Words

    def __len__(self) -> int:
        """Number of frames."""
        return len(self.stamp_s)

    def __repr__(self) -> str:
        return f"<softarm.Mismatch: {len(self)} frames, {int(self.alarm.sum())} with an alarm>"

    def to_dict(self) -> Dict[str, Any]:
        """All arrays, as lists; None for NaN."""
        return plain_dict(vars(self))

    def to_pandas(self) -> Any:
        """A DataFrame with a row per frame, indexed by ``stamp_s``."""
        columns = {name: value for name, value in vars(self).items() if name != "stamp_s"}
        module = pandas()
        return module.DataFrame(columns, index=module.Index(self.stamp_s, name="stamp_s"))
