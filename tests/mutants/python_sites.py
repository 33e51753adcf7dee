# SPDX-License-Identifier: BSD-2-Clause
"""Sites of mutation in Python. Nothing is drawn from texts, including formatted ones, nor from annotations,
decorators, assertions and raised errors."""
import ast
import io
import tokenize

from mutant import Site
from site_rules import OPPOSITE, doubled

SYMBOLS = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!="}
SYMBOLS |= {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.And: "and", ast.Or: "or"}
SWAPPED = {"max": "min", "min": "max", "maximum": "minimum", "minimum": "maximum"}


class Finder(ast.NodeVisitor):
    """Collects the sites of a module."""

    def __init__(self, file, text):
        self.file, self.text, self.sites, self.depth = file, text, [], 0
        self.starts = [0]
        for line in text.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.tokens = [
            (self.starts[token.start[0] - 1] + token.start[1], token.string)
            for token in tokenize.generate_tokens(io.StringIO(text).readline)
            if token.type in (tokenize.OP, tokenize.NAME)
        ]

    def place(self, line, column):
        """The index in the text of a line and a column, which ast counts in bytes."""
        start = self.starts[line - 1]
        head = self.text[start : self.starts[line]].encode()[:column]
        return start + len(head.decode())

    def start(self, node):
        return self.place(node.lineno, node.col_offset)

    def end(self, node):
        return self.place(node.end_lineno, node.end_col_offset)

    def add(self, start, end, replacement):
        self.sites.append(Site(self.file, self.text, start, end, replacement))

    def operator(self, kind, left, right):
        """The operator between two operands."""
        symbol = SYMBOLS.get(type(kind))
        for start, text in self.tokens:
            if symbol and text == symbol and self.end(left) <= start < self.start(right):
                self.add(start, start + len(symbol), OPPOSITE[symbol])
                return

    def visit_BinOp(self, node):
        self.operator(node.op, node.left, node.right)
        self.generic_visit(node)

    def visit_BoolOp(self, node):
        for left, right in zip(node.values, node.values[1:]):
            self.operator(node.op, left, right)
        self.generic_visit(node)

    def visit_Compare(self, node):
        for left, kind, right in zip([node.left, *node.comparators], node.ops, node.comparators):
            self.operator(kind, left, right)
        self.generic_visit(node)

    def visit_UnaryOp(self, node):
        if isinstance(node.op, ast.USub):
            self.add(self.start(node), self.start(node) + 1, "")
        self.generic_visit(node)

    def visit_Constant(self, node):
        if type(node.value) in (int, float):
            start, end = self.start(node), self.end(node)
            if changed := doubled(self.text[start:end]):
                self.add(start, end, changed)

    def visit_If(self, node):
        start, end = self.start(node.test), self.end(node.test)
        self.add(start, end, f"not ({self.text[start:end]})")
        self.generic_visit(node)

    def visit_Call(self, node):
        name = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if name in SWAPPED:
            self.add(self.end(node.func) - len(name), self.end(node.func), SWAPPED[name])
        self.generic_visit(node)

    def remove(self, node):
        if self.depth:
            self.add(self.start(node), self.end(node), "pass")

    def visit_Expr(self, node):
        if isinstance(node.value, ast.Call):
            self.remove(node)
        self.generic_visit(node)

    def visit_Assign(self, node):
        # Without the first value of a name, the next use would fail at once.
        if all(isinstance(target, (ast.Attribute, ast.Subscript)) for target in node.targets):
            self.remove(node)
        self.generic_visit(node)

    def visit_AugAssign(self, node):
        self.remove(node)
        self.visit(node.value)

    def visit_AnnAssign(self, node):
        if node.value:
            self.visit(node.value)

    def visit_Raise(self, node):
        self.remove(node)

    def visit_Assert(self, node):
        pass

    def visit_JoinedStr(self, node):
        pass

    def visit_FunctionDef(self, node):
        """The function, and its return at the start if it returns nothing."""
        self.depth += 1
        described = ast.get_docstring(node, clean=False) is not None
        first = node.body[described] if len(node.body) > described else node.body[0]
        gives = any(
            isinstance(n, (ast.Yield, ast.YieldFrom))
            or getattr(n, "value", None)
            and isinstance(n, ast.Return)
            for n in ast.walk(node)
        )
        if not gives and not isinstance(first, (ast.Pass, ast.Expr)):
            self.add(self.start(first), self.start(first), f"return\n{' ' * first.col_offset}")
        for child in (*node.args.defaults, *filter(None, node.args.kw_defaults), *node.body):
            self.visit(child)
        self.depth -= 1


def sites(file, text):
    """The sites of a Python source, in the order of the text."""
    finder = Finder(file, text)
    finder.visit(ast.parse(text))
    return sorted(finder.sites, key=lambda site: (site.start, site.end))
