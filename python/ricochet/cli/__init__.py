# SPDX-License-Identifier: BSD-2-Clause
"""The command `ricochet`: one module a verb."""
import importlib
import sys

VERBS = ("run", "plot", "report", "sweep", "tradeoff", "batch", "import", "export", "surfaces")


def main():
    verb = sys.argv[1] if len(sys.argv) > 1 else ""
    if verb not in VERBS:
        print(f"ricochet: unknown verb \"{verb}\": give one of {', '.join(VERBS)}", file=sys.stderr)
        return 2
    sys.argv = [f"ricochet {verb}", *sys.argv[2:]]
    module = importlib.import_module(f"ricochet.cli.{'import_' if verb == 'import' else verb}")
    return importlib.import_module("ricochet.cli.command_line").run(module.main)
