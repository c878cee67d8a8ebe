"""What the parts of the package share."""
import importlib
import os
import warnings
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Union

import numpy as np

from . import _softarm

if TYPE_CHECKING:
    Floats = np.ndarray[Any, np.dtype[np.float64]]
    Bools = np.ndarray[Any, np.dtype[np.bool_]]
    Words = np.ndarray[Any, np.dtype[np.str_]]
else:  # what NumPy of Ubuntu 20.04 has
    Floats = Bools = Words = np.ndarray

Path = Union[str, "os.PathLike[str]"]
Progress = Callable[[float, str], None]


class SoftarmWarning(UserWarning):
    """What was left out, or cannot be, though the call goes on."""


def warn(text: str) -> None:
    warnings.warn(text, SoftarmWarning, stacklevel=3)


def prefix() -> str:
    """Where the package is installed: this is <prefix>/lib/python3/dist-packages/softarm."""
    return os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), *[os.pardir] * 4))


def folders(kind: str) -> List[str]:
    """Where files of this kind ship ("arms", "layouts", "report"): installed beside this package, and in the checkout."""
    return [os.path.join(prefix(), "share", "softarm_estimator", "config", kind),
            os.path.join(_softarm.SOURCE_DIR, "config", kind)]


def wrong(name: str, value: Any, must: str) -> ValueError:
    """What an argument is not, in one line."""
    text = value if isinstance(value, (int, float)) else " ".join(repr(value).split())
    text = str(text)
    return ValueError(f"{name}: {text if len(text) <= 60 else text[:57] + '...'}; must be {must}")


def text_of(name: str, value: Any) -> str:
    if not isinstance(value, str) or "\0" in value:
        raise wrong(name, value, "a text")
    return value


def path_of(name: str, value: Any) -> str:
    if not isinstance(value, (str, os.PathLike)) or not os.fspath(value):
        raise wrong(name, value, "a path")
    return text_of(name, os.fspath(value))


def paths_of(paths: Union[Path, Iterable[Path]]) -> List[str]:
    """One path or several, as text."""
    if isinstance(paths, (str, os.PathLike)):
        paths = [paths]
    if isinstance(paths, bytes) or not isinstance(paths, Iterable):
        raise wrong("paths", paths, "a path or several")
    return [path_of("paths", path) for path in paths]


def number_of(name: str, value: Any, low: float, high: float, unit: str = "") -> float:
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise wrong(name, value, "a number") from None
    if not low <= number <= high:
        raise wrong(name, value, f"from {low:g} to {high:g}{unit}")
    return number


def number_or_none(name: str, value: Any) -> Optional[float]:
    try:
        return None if value is None else float(value)
    except (TypeError, ValueError, OverflowError):
        raise wrong(name, value, "a number") from None


def whole_of(name: str, value: Any, low: int, high: int, meaning: str = "") -> int:
    if isinstance(value, (float, np.floating)) and value == np.floor(value) and np.isfinite(value):
        value = int(value)
    if not isinstance(value, (int, np.integer)) or not low <= value <= high:
        raise wrong(name, value, f"from {low}{meaning} to {high}")
    return int(value)


def jobs_of(jobs: int) -> int:
    return whole_of("jobs", jobs, 0, 256, " (one per processor)")


def progress_of(progress: Optional[Progress]) -> Optional[Progress]:
    if progress is not None and not callable(progress):
        raise wrong("progress", progress, "a function of (share done, what is being done)")
    return progress


def set_options(options: Any, values: Dict[str, Any]) -> None:
    """Sets attributes of the extension's options. ValueError, in one line, for what is none of their kind."""
    for name, value in values.items():
        try:
            setattr(options, name, value)
        except TypeError:
            raise ValueError(str(wrong(name, value, "")).replace("; must be ", "; is of the wrong kind")) from None


def words_of(name: str, words: Union[str, Sequence[str]]) -> List[str]:
    """One word or several."""
    if isinstance(words, str):
        words = [words]
    if isinstance(words, bytes) or not isinstance(words, Iterable):
        raise wrong(name, words, "names")
    words = list(words)
    for word in words:
        if not isinstance(word, str) or "\0" in word:
            raise wrong(name, word, "names")
    return words


def numbers(name: str, values: Any) -> Floats:
    """Values as an array of doubles. ValueError where they are none."""
    try:
        return np.asarray(values, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        raise ValueError(f"{name}: {type(values).__name__}; must be numbers of one rectangular shape") from None


def table(values: Any, names: Sequence[str], count: Optional[int], what: str = "inputs") -> Floats:
    """By name (a mapping) or as an array (count, names): the array. A mapping's numbers hold for all rows; names left out
    are 0."""
    if isinstance(values, dict):
        columns: Dict[str, Floats] = {}
        for name, value in values.items():
            if name not in names:
                raise ValueError(f"{what}: '{name}'; the arm has {', '.join(names) or 'none'}")
            columns[name] = numbers(f"{what}['{name}']", value)
            if columns[name].ndim > 1:
                raise ValueError(f"{what}['{name}']: has the shape {columns[name].shape}; must be a number, or one per row")
        lengths = {column.shape[0] for column in columns.values() if column.ndim} | ({count} if count is not None else set())
        if len(lengths) > 1:
            raise ValueError(f"{what}: of different lengths: {', '.join(str(n) for n in sorted(lengths))}")
        rows = lengths.pop() if lengths else 1
        array = np.zeros((rows, len(names)))
        for name, column in columns.items():
            array[:, list(names).index(name)] = column
        return array
    array = numbers(what, values)
    if array.ndim == 1:
        array = array[np.newaxis, :]
    if array.ndim != 2 or array.shape[1] != len(names):
        raise ValueError(f"{what}: has the shape {array.shape}; must have (rows, {len(names)}): {', '.join(names) or 'none'}")
    return array


def plain(value: Any) -> Any:
    """As JSON would have it: lists for arrays, None for NaN."""
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float) and value != value:
        return None
    return value


def plain_dict(values: Mapping[str, Any]) -> Dict[str, Any]:
    """As ``plain``."""
    return {key: plain(item) for key, item in values.items()}


def pandas() -> Any:
    """The module pandas. ImportError with the remedy where it is not installed."""
    try:
        return importlib.import_module("pandas")
    except ImportError:
        raise ImportError("to_pandas() needs pandas: apt-get install python3-pandas; to_dict() does without") from None
