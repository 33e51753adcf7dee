# SPDX-License-Identifier: BSD-2-Clause
"""Names of files from titles, as ricochet-contact makes them."""
import re


def slug(title):
    return re.sub("[^a-z0-9]+", "-", title.lower()).strip("-") or "scene"
