#!/usr/bin/python3
"""Executes python/examples/tour.py cell by cell on a trial of the virtual rig, and renders it as doc/python.md with its
pictures and as the executed notebook python/examples/tour.ipynb (made without Jupyter).

    scripts/python scripts/python_page.py            # writes the page, the pictures and the notebook
    scripts/python scripts/python_page.py --out DIR  # into another folder, whose other files stay

Cells begin with "# %%", cells of text with "# %% [markdown]". The output of a cell, and pictures that it leaves open, follow it.
"""
import argparse
import base64
import contextlib
import io
import json
import os
import re
import subprocess
import tempfile

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TOUR = os.path.join(ROOT, "python", "examples", "tour.py")


def cells_of(text):
    """("markdown" or "code", text) of each cell."""
    for head, body in re.findall(r"^# %%(.*)\n((?:(?!# %%).*\n?)*)", text, re.M):
        body = body.strip("\n")
        if "markdown" in head:
            yield "markdown", "\n".join(line[2:] if line.startswith("# ") else line[1:] for line in body.split("\n"))
        else:
            yield "code", body


def execute(cells):
    """Adds to each cell what it printed, and its pictures as PNG."""
    names = {}
    for kind, text in cells:
        printed, pictures = "", []
        if kind == "code":
            with contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(text, TOUR, "exec"), names)  # of this checkout
            printed = out.getvalue()
            for number in plt.get_fignums():
                png = io.BytesIO()
                plt.figure(number).savefig(png, format="png", dpi=80, metadata={"Software": None})
                pictures.append(png.getvalue())
            plt.close("all")
        yield kind, text, printed, pictures


def write_page(cells, folder, name="python"):
    lines, count = [], 0
    for kind, text, printed, pictures in cells:
        lines.append(text if kind == "markdown" else f"```python\n{text}\n```")
        if printed:
            lines.append("prints\n\n```text\n" + printed.rstrip("\n") + "\n```")
        for png in pictures:
            count += 1
            file = f"images/{name}_{count}.png"
            os.makedirs(os.path.join(folder, "images"), exist_ok=True)
            with open(os.path.join(folder, file), "wb") as picture:
                picture.write(png)
            lines.append(f"![What the cell above draws]({file})")
    with open(os.path.join(folder, f"{name}.md"), "w", encoding="utf-8") as page:
        page.write("\n\n".join(lines) + "\n")


def write_notebook(cells, path):
    made = []
    for k, (kind, text, printed, pictures) in enumerate(cells):
        cell = {"cell_type": kind, "id": f"cell-{k}", "metadata": {}, "source": text.splitlines(keepends=True)}
        if kind == "code":
            outputs = [{"name": "stdout", "output_type": "stream", "text": printed.splitlines(keepends=True)}] if printed else []
            outputs += [{"data": {"image/png": base64.b64encode(png).decode()}, "metadata": {}, "output_type": "display_data"}
                        for png in pictures]
            cell.update(execution_count=sum(one["cell_type"] == "code" for one in made) + 1, outputs=outputs)
        else:  # links of the page are by its folder
            cell["source"] = re.sub(r"\]\((?!\.\./|https?:|#)([^)]+)\)", r"](../../doc/\1)",
                                    re.sub(r"\]\(\.\./", "](../../", text)).splitlines(keepends=True)
        made.append(cell)
    notebook = {"cells": made, "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
                                            "language_info": {"name": "python"}}, "nbformat": 4, "nbformat_minor": 5}
    with open(path, "w", encoding="utf-8") as file:
        json.dump(notebook, file, indent=1)
        file.write("\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", help="folder for page, pictures and notebook (default: their places in the checkout)")
    parser.add_argument("--program", default=os.path.join(ROOT, "scripts", "softarm"), help="default: scripts/softarm")
    arguments = parser.parse_args()
    page_folder = os.path.abspath(arguments.out or os.path.join(ROOT, "doc"))
    notebook = os.path.join(page_folder if arguments.out else os.path.dirname(TOUR), "tour.ipynb")
    with open(TOUR, encoding="utf-8") as file:
        cells = list(cells_of(file.read()))
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([arguments.program, "simulate", "demo", "--seconds", "20", "--out", os.path.join(folder, "trial.bag")],
                       check=True, stdout=subprocess.DEVNULL)
        os.chdir(folder)
        done = list(execute(cells))
        os.chdir(ROOT)
    os.makedirs(page_folder, exist_ok=True)
    write_page(done, page_folder)
    write_notebook(done, notebook)


if __name__ == "__main__":
    main()
