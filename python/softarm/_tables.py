"""Tables that the programs write: estimates.csv, trial.truth.csv, shapes.csv ..."""
import csv
from typing import Dict, Sequence

import numpy as np

from ._common import Floats, Path, path_of, words_of
from ._softarm import Error


def _numbers(cells: Sequence[str]) -> Floats:
    if any("_" in cell for cell in cells):  # trial_1, and 12_1: Python would take that for 121
        raise ValueError
    return np.array([float(cell) if cell else np.nan for cell in cells])


def read_table(path: Path, columns: Sequence[str] = (), *, texts: Sequence[str] = ()) -> Dict[str, Floats]:
    """The columns of the CSV table ``path`` by name, in its order: floats, NaN where a cell is empty; text where a cell is no number.

    ``columns``: those that it must have; ``texts``: those that are text whatever is in them, as names of trials. Raises Error (one line with the file) where it cannot be read, is no table, has no
    row or lacks a column.
    """
    path, columns, texts = path_of("path", path), words_of("columns", columns), words_of("texts", texts)
    said = " ".join(path.split())
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
    except (OSError, UnicodeDecodeError, csv.Error) as why:
        raise Error(f"{said}: {getattr(why, 'strerror', None) or 'no text'}") from None
    head = rows[0] if rows else []
    missing = [name for name in columns if name not in head]
    if missing or len(rows) < 2:
        raise Error(f"{said}: no column {missing[0]}" if missing else f"{said}: has no rows")
    if any(len(row) != len(head) for row in rows):
        raise Error(f"{said}: its rows have different numbers of cells")
    table: Dict[str, Floats] = {}
    for name, cells in zip(head, zip(*rows[1:])):
        try:
            table[name] = np.array(cells) if name in texts else _numbers(cells)
        except ValueError:
            table[name] = np.array(cells)
    return table
