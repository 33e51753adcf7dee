# SPDX-License-Identifier: BSD-2-Clause
"""Tables in Markdown on standard output, and figures in files."""
from ricochet import files


class Table:
    """Prints the header at once and each row as soon as it is known.

    @param columns  (title, value, format): the value is a key of the row or a function of it
    """

    def __init__(self, columns):
        self.columns = columns
        print(f"| {' | '.join(title for title, _, _ in columns)} |\n{'|---' * len(columns)}|", flush=True)

    def row(self, row):
        values = ((of(row) if callable(of) else row[of], form) for _, of, form in self.columns)
        print(f"| {' | '.join(show(value, form) for value, form in values)} |", flush=True)


def show(value, form=".1e"):
    if isinstance(value, list):
        return " ".join(show(item, form) for item in value)
    return "–" if value is None else f"{value:{form}}"


def save(figure, path):
    files.save_picture(figure, path, dpi=150)
    print(path)
