# SPDX-License-Identifier: BSD-2-Clause
"""Runs in turn, their medians and ratios, and processor times."""
import resource
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


def median(runs, key="seconds"):
    return statistics.median(run[key] for run in runs)


def speedup(runs, reference):
    """How many times as fast as the reference these runs are, by the medians."""
    return median(reference) / median(runs)


def children_seconds():
    """Processor time of the processes that have ended [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
