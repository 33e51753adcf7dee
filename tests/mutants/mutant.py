# SPDX-License-Identifier: BSD-2-Clause
"""A place where a source can be mutated, and the seeded draw of such places."""
import dataclasses
import hashlib


@dataclasses.dataclass(frozen=True)
class Site:
    """The characters from `start` to `end` of the text of a file, and what replaces them."""

    file: str
    text: str = dataclasses.field(repr=False)
    start: int
    end: int
    replacement: str

    @property
    def line(self):
        return self.text.count("\n", 0, self.start) + 1

    @property
    def mutated(self):
        """The text of the whole file with the replacement."""
        return self.text[: self.start] + self.replacement + self.text[self.end :]

    def _lines(self):
        first = self.text.rfind("\n", 0, self.start) + 1
        last = self.text.find("\n", self.end)
        return first, len(self.text) if last < 0 else last

    @property
    def before(self):
        """The lines of the site, with single spaces."""
        first, last = self._lines()
        return " ".join(self.text[first:last].split())

    @property
    def after(self):
        first, last = self._lines()
        line = self.text[first : self.start] + self.replacement + self.text[self.end : last]
        return " ".join(line.split())

    def context(self, margin=3):
        """Lines around the site with their numbers; those of the site are marked."""
        lines = self.text.splitlines()
        last = self.line + self.text.count("\n", self.start, self.end)
        return "\n".join(
            f"{'>' if self.line <= n <= last else ' '}{n:5} {lines[n - 1]}"
            for n in range(max(1, self.line - margin), min(len(lines), last + margin) + 1)
        )


@dataclasses.dataclass(frozen=True)
class Mutant:
    """A site with the key that decides when it is drawn."""

    folder: str
    site: Site
    key: str

    @property
    def name(self):
        return f"{self.folder}/{self.key[:8]}"

    def __str__(self):
        site = self.site
        return f"{self.name}  {site.file}:{site.line}\n    - {site.before}\n    + {site.after}"


def draw(folder, sites, seed):
    """All sites in the order of a draw without replacement, each equally likely to be the next. The place of a
    site in that order depends on the seed, its file and its lines alone. Thus, the same mutants are drawn after
    changes of other lines."""
    seen, mutants = {}, []
    for site in sites:
        what = "\0".join((str(seed), site.file, site.before, site.after))
        seen[what] = seen.get(what, 0) + 1  # equal lines of a file differ by their order
        mutants.append(Mutant(folder, site, hashlib.sha256(f"{what}\0{seen[what]}".encode()).hexdigest()))
    return sorted(mutants, key=lambda mutant: mutant.key)
