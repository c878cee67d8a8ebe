"""The Python module softarm, for the scripts of this folder: of a sourced install space, or of this checkout's build."""
import os
import sys

_ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
_BUILD = os.environ.get("SOFTARM_BUILD_DIR", os.path.join(_ROOT, "build"))
sys.path += [os.path.join(_BUILD, space, "lib", "python3", "dist-packages") for space in ("install", "devel")]
try:
    import softarm  # noqa: F401
except ImportError as why:
    sys.exit(f"{os.path.basename(sys.argv[0])}: {why}: scripts/python builds the module softarm, for Debian's python3")


def rows_of(path):
    """Rows of a table as dicts: numbers, texts, None where a cell is empty. Ends the script where there is none."""
    try:
        table = softarm.read_table(path, texts=["trial", "body"])
    except softarm.Error as why:
        sys.exit(f"{os.path.basename(sys.argv[0])}: {why}")
    columns = [[None if cell != cell or cell == "" else cell for cell in column.tolist()] for column in table.values()]
    return [dict(zip(table, cells)) for cells in zip(*columns)]
