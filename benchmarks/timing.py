# SPDX-License-Identifier: BSD-2-Clause
"""Alternating runs, and their medians."""
import statistics


def alternate(rounds, candidates):
    """Runs every candidate once per round, one after the other, so that other work on the machine slows all
    of them alike.

    @param candidates  functions without arguments, by name
    @return  the values that each returned, by name, in the order of the rounds
    """
    found = {name: [] for name in candidates}
    for _ in range(rounds):
        for name, run in candidates.items():
            found[name].append(run())
    return found


def median(runs):
    return statistics.median(run["seconds"] for run in runs)
