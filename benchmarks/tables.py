# SPDX-License-Identifier: BSD-2-Clause
"""Tables in Markdown on standard output, and figures in files."""


def head(cells):
    print("| " + " | ".join(cells) + " |\n" + "|---" * len(cells) + "|", flush=True)


def row(cells):
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def show(value, form=".1e"):
    return "–" if value is None else f"{value:{form}}"


def pyplot():
    """matplotlib.pyplot for files alone."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    return plt
