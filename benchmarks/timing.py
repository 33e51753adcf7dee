# SPDX-License-Identifier: BSD-2-Clause
"""Runs in turn, and their medians."""
import statistics


def alternate(rounds, candidates):
    """Runs every candidate once a round, one after the other, so that other work on the machine slows all
    alike.

    @param candidates  functions without arguments, by name
    @return  what each returned, in the order of the rounds, by name
    """
    found = {name: [] for name in candidates}
    for _ in range(rounds):
        for name, run in candidates.items():
            found[name].append(run())
    return found


def median(runs):
    return statistics.median(run["seconds"] for run in runs)
