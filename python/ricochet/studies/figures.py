# SPDX-License-Identifier: BSD-2-Clause
"""Columns of a study for parts of a scene, KIND.NAME.FIGURE: the figures of each kind, and their labels with units."""

from ricochet.studies.study import WORDS

_FILTERED = {
    f"cfc_{number}": f"largest acceleration of {{}} behind CFC {number} (m/s²)"
    for number in (60, 180, 600, 1000)  # classes of SAE J211-1
}

#: by kind and figure, the label, with {} for the name of the receiver, body or gauge
LABELS = {
    "acceleration": {
        "peak": "largest acceleration of {} (m/s²)",
        "time_s": "time of the largest acceleration of {} (s)",
        **_FILTERED,
    },
    "stress": {
        "von_mises_pa": "largest von Mises stress of {} (Pa)",
        "time_s": "time of the largest von Mises stress of {} (s)",
        "ratio_to_yield": "largest von Mises stress of {}, relative to yield",
    },
    "gauges": {
        "von_mises_pa": "largest von Mises stress of {} (Pa)",
        "von_mises_time_s": "time of the largest von Mises stress of {} (s)",
        "strain_peak": "largest strain of {}",
        "strain_time_s": "time of the largest strain of {} (s)",
    },
}


def label(column: str) -> str | None:
    """The label of such a column; None for other names."""
    kind, _, rest = column.partition(".")
    name, _, figure = rest.rpartition(".")
    text = LABELS.get(kind, {}).get(figure)
    return text.format(name) if text and name else None


def is_record(name: str) -> bool:
    """Whether a study could keep a record of this name, values over time, such as acceleration.mic.x; it is no column then,
    such as acceleration.mic.peak."""
    return name.partition(".")[0] in WORDS and label(name) is None
