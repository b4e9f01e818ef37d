"""Blocks of Fanuc programs, and the moves that they make."""

import re
from dataclasses import dataclass

WORD = re.compile(r"(,?[A-Z])\s*([-+]?(?:\d+\.?\d*|\.\d+))")
MACRO = re.compile(r"#|\bIF\b|\bWHILE\b|\bGOTO\b|\bG66\b")


@dataclass
class Move:
    kind: str
    x: float
    z: float
    center: tuple | None = None
    rate: tuple | float | None = None
    line: int = 0
    rule: str = ""
    begin: tuple | None = None


class Unknown(Exception):
    """The program needs something that the model does not have."""


@dataclass
class Block:
    line: int
    n: int | None
    g: list
    m: list
    words: dict

    def has_axis(self):
        return any(letter in self.words for letter in "XZUW")


def parse(text):
    """Programs by number; each a list of blocks."""
    programs, name, blocks = {}, 0, []
    programs[0] = blocks
    for line, row in enumerate(text.splitlines(), 1):
        row = re.sub(r"\([^)]*\)", "", row).split(";")[0].replace("%", "").strip()
        if row.startswith(":"):
            row = "O" + row[1:]
        if not row:
            continue
        if MACRO.search(row):
            raise Unknown("macro")
        g, m, words, n = [], [], {}, None
        for letter, value in WORD.findall(row):
            if letter == "O":
                blocks = programs[int(value)] = []
            elif letter == "N":
                n = int(value)
            elif letter == "G":
                g.append(float(value))
            elif letter == "M":
                m.append(int(value))
            else:
                words[letter] = value
        if g or m or words:
            blocks.append(Block(line, n, g, m, words))
    if not programs[0]:
        del programs[0]
    return programs
