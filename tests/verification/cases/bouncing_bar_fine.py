"""The bar of `bouncing_bar` with up to 800 modes, over 40 touches."""
from cases import bouncing_bar

TITLE = "The bouncing bar over 40 touches"
SOURCE = "As for `bouncing_bar`."
LONG = True


def run(bench):
    bouncing_bar.run(bench, counts=(100, 200, 400, 800), duration=108.0, bound=0.15)
