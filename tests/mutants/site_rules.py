# SPDX-License-Identifier: BSD-2-Clause
"""What replaces operators and numbers, the same in C++ and Python."""
import re

OPPOSITE = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&"}
OPPOSITE |= {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
OPPOSITE |= {"and": "or", "or": "and"}
INTEGER = re.compile(r"(\d(?:['_]?\d)*)([uUlLzZ]*)")


def doubled(number):
    """The literal of another number: n + 1 for an integer n, 1 for 0.0, and otherwise twice the number. None for
    hexadecimal numbers and others that are patterns of bits."""
    if match := INTEGER.fullmatch(number):
        if len(match[1]) > 1 and match[1][0] == "0":
            return None
        return f"{int(re.sub(chr(39), '', match[1])) + 1}{match[2]}"
    if number[:2].lower() in ("0x", "0b", "0o"):
        return None
    value = number.replace("'", "").rstrip("fFlL")
    return "1.0" if float(value) == 0 else f"(2 * {number})"
