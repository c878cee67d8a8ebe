"""What the plotting scripts share: matplotlib without a screen, columns that are numbers, one line where something cannot be drawn."""
import contextlib
import os
import sys

try:
    import matplotlib
except ImportError as missing:
    sys.exit(f"{os.path.basename(sys.argv[0])}: {missing}: apt-get install python3-matplotlib")

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402,F401  (the backend is chosen first)


def die(why):
    sys.exit(f"{os.path.splitext(os.path.basename(sys.argv[0]))[0]}: {' '.join(str(why).split())}")


@contextlib.contextmanager
def one_line():
    """What the module cannot read or do ends the script with its line."""
    from softarm_module import softarm  # not wanted by all that plot
    try:
        yield
    except softarm.Error as why:
        die(why)


def table_of(path, numbers, texts=()):
    """The table of a file that has these columns of numbers, and these of texts. Ends the script where it has not."""
    from softarm_module import softarm
    with one_line():
        table = softarm.read_table(path, [*numbers, *texts], texts=texts)
    for name in numbers:
        if table[name].dtype.kind != "f":
            die(f"{path}: column {name} has a cell that is no number")
    return table


def save(figure, path, **how):
    try:
        figure.savefig(path, **how)
    except (OSError, ValueError) as why:
        die(f"{path}: cannot be written: {getattr(why, 'strerror', None) or why}")
