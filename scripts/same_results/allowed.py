"""The list of differences that are meant."""

import re
from fnmatch import fnmatch

from .text import keeping_lines, numbers, words

# The head of a new entry; `file` is optional.
FIELD = re.compile(r"(file: |- ?|\+ ?)(.*)")
SHORTEST = 4


class Entry:
    """One difference: a piece of text before and after, of which one may be nothing, in the files that match."""

    def __init__(self, line, files, before, after):
        self.line, self.files, self.before, self.after = line, files, before, after
        self.patterns = {"before": fragment_pattern(before), "after": fragment_pattern(after)}
        self.used = False
        self.group = line

    def is_for(self, file):
        return any(fnmatch(file, glob) for glob in self.files)

    @property
    def marker(self):
        """What takes the place of either text: counted like a number, unless one of the texts is nothing."""
        return f"\u27e6{self.group}\u27e7" if self.before and self.after else " "

    def apply(self, text, side):
        """The marker instead of the text before; after the change, instead of either text."""
        longest_first = sorted(["before", "after"], key=lambda name: -len(getattr(self, name)))
        for name in longest_first if side == "after" else ["before"]:
            if (pattern := self.patterns[name]) is not None:
                text, count = pattern.subn(lambda m: keeping_lines(m.group(), self.marker), text)
                self.used |= count > 0 and side == name
        return text


class AllowList:
    """All entries of a file."""

    def __init__(self, entries):
        # long ones first: a short piece may be part of a long one
        self.entries = sorted(entries, key=lambda entry: -max(len(entry.before), len(entry.after)))
        # what has become the same text gets the same marker, however it was written before
        first = {}
        for entry in self.entries:
            entry.group = first.setdefault(entry.after or entry.before, entry.line)

    @classmethod
    def read(cls, path):
        entries, block = [], []
        for number, line in enumerate([*(path.read_text().splitlines() if path.exists() else []), ""], 1):
            if line.startswith("#"):
                continue
            if line.strip():
                block.append((number, line))
            elif block:
                entries.append(parsed(path, block))
                block = []
        return cls(entries)

    def apply(self, text, side, file):
        """A text with markers for what may differ."""
        for entry in self.entries:
            if entry.is_for(file):
                text = entry.apply(text, side)
        return text

    def unused(self):
        return sorted((entry for entry in self.entries if not entry.used), key=lambda entry: entry.line)


def parsed(path, block):
    """An entry from its lines."""
    files, texts = [], {"-": [], "+": []}
    for number, line in block:
        match = FIELD.fullmatch(line)
        if match is None:
            raise ValueError(f"{path}:{number}: expected 'file: ', '- ' or '+ '")
        head, text = match.groups()
        if head == "file: ":
            files.append(text.strip())
        else:
            texts[head[0]].append(text)
    before, after = (" ".join(" ".join(texts[sign]).split()) for sign in "-+")
    if max(len(before), len(after)) < SHORTEST:
        raise ValueError(f"{path}:{block[0][0]}: too short a text; take more of the line")
    return Entry(block[0][0], files or ["*"], before, after)


def fragment_pattern(text):
    """Finds a piece of text, however its lines are broken, where it does not begin or end within a word or number."""
    if not text:
        return None
    begin = r"(?<![A-Za-z0-9_.])" if re.match(r"[A-Za-z0-9_.]", text) else ""
    end = r"(?![A-Za-z0-9_])(?!\.\d)" if re.search(r"[A-Za-z0-9_.]$", text) else ""
    return re.compile(begin + r"\s+".join(map(re.escape, text.split())) + end)


# A round tube's section, as it was and as it is: its diameter twice, or once behind a sign for diameters.
TUBE_BEFORE = re.compile(r"(?:round )?(?<![\d.])([\d.]+) x \1 x ([\d.]+) mm")
TUBE_AFTER = re.compile(r"[Øø\u2300] ?([\d.]+) x ([\d.]+) mm")


def round_tubes(before, after):
    """The sections of round tubes by which two pieces of text differ, (before, after) each, if nothing else differs."""
    found = {}
    for match in TUBE_AFTER.finditer(after):
        size = match.groups()
        old = next((m.group() for m in TUBE_BEFORE.finditer(before) if m.groups() == size and m.group() not in found), None)
        old = old or next((m.group() for m in TUBE_BEFORE.finditer(before) if m.groups() == size), None)
        if old is not None:
            found[old] = match.group()
    entries = [Entry(i, ["*"], *pair) for i, pair in enumerate(found.items())]
    for entry in entries:
        before, after = entry.apply(before, "before"), entry.apply(after, "after")
    return list(found.items()) if words(numbers(before)) == words(numbers(after)) else []


def entry_text(before, after, files):
    """An entry in the list's format."""
    lines = ["", "# why:"]
    unique = sorted(set(files))
    if len(unique) == 1 and unique != ["*"]:
        lines.append(f"file: {unique[0]}")
    lines += [f"- {line.strip()}" for line in before.splitlines() if line.strip()]
    lines += [f"+ {line.strip()}" for line in after.splitlines() if line.strip()]
    return "\n".join(lines)
