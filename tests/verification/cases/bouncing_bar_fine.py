# SPDX-License-Identifier: BSD-2-Clause
"""The bar of `bouncing_bar` with up to 400 modes, and over 60 s with 22 touches, where no computation can follow the periodic motion, because
it is unstable. A deviation grows by a constant factor in each period, until touches split and the bar rattles. This is a property
of the bar: the wave equation, solved by the method of characteristics, which is exact except for the instants at which touches begin and
end, behaves likewise. The case therefore compares the growth over many touches."""
import numpy as np

from case import BLUE, GREY
from cases import bouncing_bar as bar

TITLE = "The bouncing bar over 22 touches: an unstable motion"
SOURCE = bar.SOURCE + " Growth: the method of characteristics on 400 cells, in the case."
RESTS_ON = "theory"
LONG = True
DURATION, MODES = 60.0, 400


def characteristics(cells, duration):
    """Time and height of the foot, from u(x, t+τ) = u(x+cτ, t) + u(x−cτ, t) − u(x, t−τ) − gτ², which is exact for the bar, with
    reflection at its free ends."""
    step = bar.LENGTH / bar.SPEED / cells
    fall = bar.GRAVITY * step**2
    now = np.full(cells + 1, bar.HEIGHT)
    before, foot = now - fall / 2, [bar.HEIGHT]
    for _ in range(round(duration / step)):
        after = np.concatenate([now[1:], now[-2:-1]]) + np.concatenate([now[1:2], now[:-1]]) - before - fall
        after[0] = max(after[0], 0)
        before, now = now, after
        foot.append(now[0])
    return step * np.arange(len(foot)), np.array(foot)


def departures(time, foot):
    """Root mean square of the deviation in each period, divided by h₀."""
    square = (foot - bar.exact(time)[0]) ** 2
    starts = np.arange(bar.FALL, time[-1] - bar.PERIOD, bar.PERIOD)
    return (
        np.array([np.sqrt(square[(time > t) & (time <= t + bar.PERIOD)].mean()) for t in starts]) / bar.HEIGHT
    )


def growth(departure):
    """Growth factor per period, for deviations between 0.02 and 0.3 of h₀."""
    upto = int(np.argmax(departure > 0.3)) or len(departure)
    inside = np.flatnonzero(departure[:upto] > 0.02)
    return np.exp(np.polyfit(inside, np.log(departure[inside]), 1)[0])


def run(bench):
    bar.run(bench, counts=(100, 200, MODES), bound=0.05)
    result = bench.contact(
        bench.folder / "bar.toml",
        f"modes={{count={MODES}}}",
        f"bodies.bar.geometry={{elements={MODES}}}",
        f"time.rate_hz={30 * MODES}",
        f"time.duration={DURATION}",
        "output.every=100",
    )
    ours = departures(result.receiver_time, bar.HEIGHT + result.receivers["foot"].displacement[:, 0])
    theirs = departures(*characteristics(MODES, DURATION))
    bench.compare(
        "growth of a deviation, factor per period",
        growth(ours),
        growth(theirs),
        0.1,
        "a fit over the periods between 0.02 and 0.3 h₀",
    )
    followed = [2 * int(np.argmax(d > 0.1)) for d in (ours, theirs)]
    bench.compare(
        "touches until the foot deviates by a tenth of h₀",
        *followed,
        4,
        "two periods: modes and cells deviate differently at first",
        absolute=True,
    )
    figure, ax = bench.figure()
    touch = 2 * np.arange(1, len(ours) + 1)
    ax.semilogy(touch, ours, "o-", color=BLUE, markersize=4, label=f"{MODES} modes")
    ax.semilogy(touch, theirs, "s--", color=GREY, markersize=4, label=f"characteristics, {MODES} cells")
    ax.set(
        xlabel="touches", ylabel="departure from the closed form / h₀", title="An unstable periodic motion"
    )
    ax.legend()
    bench.save(
        figure,
        "Bouncing bar: growth of the deviation from the periodic motion, two touches per period",
        "growth",
    )
