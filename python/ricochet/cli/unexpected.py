# SPDX-License-Identifier: BSD-2-Clause
"""What is wrong with words of a command line, and what to write in their place."""
import difflib
from collections.abc import Iterable, Sequence
from pathlib import Path

from ricochet.cli.options import Parser

ALIASES = {
    "help": "--help",
    "version": "--version",
    "contact": "impact",
    "simulate": "run",
    "solve": "run",
    "draw": "plot",
    "show": "plot",
}
VERBS_OF_FILES = {".toml": "run", ".h5": "plot", ".step": "surfaces", ".geo": "surfaces", ".msh": "surfaces"}


def verb_complaint(words: Sequence[str], verbs: Iterable[str]) -> str:
    """About a first word that is no verb: a file, or a similar word."""
    word = words[0]
    verb = VERBS_OF_FILES.get(Path(word).suffix, "run" if Path(word).exists() else None)
    if verb:
        named = next((other for other in words[1:] if other in verbs), None)
        rest = [other for other in words if other != named]
        return f"{word} is a file: the verb comes first: ricochet {' '.join([named or verb, *rest])}"
    near = [ALIASES[word]] if word in ALIASES else difflib.get_close_matches(word, verbs, 1, 0.4)
    hint = f'did you mean "{near[0]}"?' if near else f"the verbs are {', '.join(verbs)}"
    return f'there is no verb "{word}": {hint}'


def open_brackets(text: str) -> int:
    return sum((c in "[{") - (c in "]}") for c in text)


def split_setting(words: Sequence[str]) -> str | None:
    """About a value of --set that the shell has split at blanks, or that follows its key as a separate word."""
    for number, word in enumerate(words[:-2]):
        key, value = words[number + 1 : number + 3]
        if word != "--set":
            continue
        if "=" not in key and not value.startswith("-"):
            return f"--set {key} {value}: write --set {key}={value}"
        for end in range(number + 3, len(words) + 1):
            whole = " ".join(words[number + 1 : end])
            if open_brackets(key) > 0 and open_brackets(whole) == 0:
                return f"--set {key}: the shell splits a value at blanks: quote it, --set '{whole}'"
    return None


def options_of(parser: Parser) -> set[str]:
    """The options in the help of a verb, with those of its program."""
    words = parser.format_help().replace(",", " ").replace("[", " ").split()
    return {word for word in words if word.startswith("-") and word.strip("-")}


def complaint(
    parser: Parser,
    words: Sequence[str],
    rest: Sequence[str],
    others: Iterable[Parser],
) -> str:
    """About `rest`, the words that the parser of a verb did not expect among `words`. `others` are the parsers
    of the other verbs."""
    if split := split_setting(words):
        return split
    word = rest[0].partition("=")[0]
    if word.startswith("-"):
        if near := difflib.get_close_matches(word, options_of(parser), 1, 0.7):
            return f"{word}: there is no such option: did you mean {near[0]}?"
        if owner := next((other.prog for other in others if word in options_of(other)), None):
            return f"{word}: is an option of {owner}, not of {parser.prog}: leave it out"
        return f"{word}: there is no such option"
    if "=" in rest[0]:
        return f"{rest[0]}: is not an option: write --set '{rest[0]}'"
    return f"{rest[0]}: is one word too many: give one {parser.input()}"
