# SPDX-License-Identifier: BSD-2-Clause
"""Sites of mutation in C++ that clang-format has formatted.

Thanks to the format a lexer is enough: a binary operator stands between spaces, and no bracket of a template and
no pointer or reference does. Nothing is drawn from comments, texts, directives of the preprocessor, assertions,
thrown errors and the arguments of formatted texts.
"""
import dataclasses
import re

from site_rules import OPPOSITE, doubled
from mutant import Site

TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
  |(?P<directive>^[ \t]*\#(?:[^\n]*\\\n)*[^\n]*)
  |(?P<string>R"(?P<mark>[^()\s\\]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')
  |(?P<number>\.?\d(?:[eEpP][+-]|['\w.])*)
  |(?P<word>[A-Za-z_]\w*)
  |(?P<space>\s+)
  |(?P<sign><=>|->|\+\+|--|&&|\|\||::|<<|\.\.\.|[-+*/%&|^=!<>]=|.)""",
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
OPEN, CLOSE = "([{", ")]}"
ASSERTIONS = {"assert", "static_assert"}
TEXTS = ASSERTIONS | {"format"}
KEYWORDS = {
    "return",
    "break",
    "continue",
    "using",
    "namespace",
    "case",
    "default",
    "goto",
    "delete",
    "else",
    "if",
}
KEYWORDS |= {
    "for",
    "while",
    "do",
    "switch",
    "try",
    "catch",
    "class",
    "struct",
    "template",
    "typedef",
    "co_return",
}
ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^="}
SWAPPED = {"max": "min", "min": "max", "maxCoeff": "minCoeff", "minCoeff": "maxCoeff"}


@dataclasses.dataclass(frozen=True)
class Token:
    kind: str
    text: str
    start: int

    @property
    def end(self):
        return self.start + len(self.text)


def tokens(text):
    """The tokens of a text without spaces, comments and directives."""
    found = (
        Token(match.lastgroup if match.lastgroup != "mark" else "string", match[0], match.start())
        for match in TOKEN.finditer(text)
    )
    return [token for token in found if token.kind not in ("space", "comment", "directive")]


class Source:
    """The tokens of a file, closed by an empty one, with the partner of each bracket."""

    def __init__(self, file, text):
        self.file, self.text = file, text
        self.tokens = [*tokens(text), Token("sign", "", len(text))]
        self.partner, opened = {}, []
        for i, token in enumerate(self.tokens):
            if token.kind == "sign" and token.text in OPEN and token.text:
                opened.append(i)
            elif token.kind == "sign" and token.text in CLOSE and token.text and opened:
                self.partner[i] = opened.pop()
                self.partner[self.partner[i]] = i

    def at(self, i):
        return self.tokens[i].text if 0 <= i < len(self.tokens) else ""

    def site(self, start, end, replacement):
        return Site(self.file, self.text, start, end, replacement)

    def statement_end(self, i):
        """The semicolon that ends the statement of token i, or None."""
        while i < len(self.tokens) - 1 and self.at(i) not in (*CLOSE, ";"):
            i = self.partner.get(i, i) + 1
        return i if self.at(i) == ";" else None

    def starts_statement(self, i):
        before = self.at(i - 1)
        if before == ")":
            return self.at(self.partner.get(i - 1, 0) - 1) in ("if", "for", "while", "constexpr")
        return before in (";", "{", "}", "else")

    def excluded(self):
        """Indices of the tokens from which nothing is drawn."""
        inside = set()
        for i, token in enumerate(self.tokens):
            if token.kind != "word":
                continue
            end = None
            if token.text in TEXTS and self.at(i + 1) == "(":
                end = self.partner.get(i + 1)
            elif token.text in ("throw", "using"):
                end = self.statement_end(i)
            elif token.text == "enum":
                end = self.statement_end(i)
            elif token.text == "operator":
                end = i + 1
            if end is not None:
                inside.update(range(i + 1, end))
        return inside


def _operators(source, i):
    token = source.tokens[i]
    spaced = (
        source.text[token.start - 1 : token.start].isspace()
        and source.text[token.end : token.end + 1].isspace()
    )
    if token.kind == "sign" and spaced and token.text in OPPOSITE:
        yield source.site(token.start, token.end, OPPOSITE[token.text])


def _numbers(source, i):
    token = source.tokens[i]
    if token.kind == "number" and (changed := doubled(token.text)):
        yield source.site(token.start, token.end, changed)


def _signs(source, i):
    token, before = source.tokens[i], source.tokens[i - 1]
    operand = before.kind in ("number", "string") or before.text in (")", "]", "}")
    operand = operand or (before.kind == "word" and before.text not in ("return", "case"))
    if token.text == "-" and not operand and not source.text[token.end].isspace():
        yield source.site(token.start, token.end, "")


def _conditions(source, i):
    if source.tokens[i].kind != "word" or source.at(i) != "if" or source.at(i + 1) != "(":
        return
    close, first = source.partner[i + 1], i + 2
    inside = first
    while inside < close:  # a condition may follow an initialisation
        if source.at(inside) == ";":
            first = inside + 1
        inside = source.partner.get(inside, inside) + 1
    start, end = source.tokens[first].start, source.tokens[close].start
    yield source.site(start, end, f"!({source.text[start:end]})")


def _swaps(source, i):
    word = source.at(i)
    standard = source.at(i - 1) == "::" and source.at(i - 2) == "std"
    if source.tokens[i].kind == "word" and word in SWAPPED and source.at(i + 1) in ("(", "<"):
        if standard or (source.at(i - 1) in (".", "->") and word.endswith("Coeff")):
            yield source.site(source.tokens[i].start, source.tokens[i].end, SWAPPED[word])


def _statements(source, i):
    """A thrown error, an assignment, or a call whose value is not used, without it. A declaration has two words or
    a template in succession before its value, and is left."""
    if not source.starts_statement(i):
        return
    j = i + 1 if source.at(i) in ("*", "++", "--") else i
    if source.tokens[j].kind != "word" or source.at(j) in KEYWORDS | ASSERTIONS:
        return
    if source.at(i) != "throw":
        j, word = j + 1, True
        while True:
            if source.at(j) in ("(", "["):
                j, word = source.partner.get(j, j) + 1, True
            elif source.at(j) in ("::", ".", "->"):
                j, word = j + 1, False
            elif source.tokens[j].kind == "word" and not word:
                j, word = j + 1, True
            else:
                break
        called = source.at(j) == ";" and (source.at(j - 1) == ")" or source.at(i) in ("++", "--"))
        if not called and source.at(j) not in ASSIGNMENTS:
            return
    if (end := source.statement_end(i)) is not None:
        yield source.site(source.tokens[i].start, source.tokens[end].start, "")


def _returns(source, i):
    """A function that returns nothing, without its body."""
    if source.at(i) != "void" or source.at(i - 1) in ("(", ","):
        return
    j = i + 1
    while source.tokens[j].kind == "word" or source.at(j) in ("::", "~"):
        j += 1
    if source.at(j) != "(" or j == i + 1:
        return
    j = source.partner[j] + 1
    while source.at(j) in ("const", "noexcept", "override", "final"):
        j += 1
    if source.at(j) == "{" and source.at(j + 1) != "}":
        yield source.site(source.tokens[j].end, source.tokens[j].end, " return;")


def sites(file, text):
    """The sites of a C++ source, in the order of the text."""
    source = Source(file, text)
    excluded = source.excluded()
    return [
        site
        for i in range(1, len(source.tokens) - 1)
        if i not in excluded
        for rule in (_operators, _numbers, _signs, _conditions, _swaps, _statements, _returns)
        for site in rule(source, i)
    ]
