"""Compares what both builds gave."""

import json
from collections import Counter
from dataclasses import dataclass, field

from .sequence import around, unequal_pieces
from .text import masked, numbers, words

# Keys of JSON that may differ from run to run or from build to build.
# Hashes of files that have times in them differ too; the files themselves are compared.
IGNORED_KEYS = {"elapsed_s", "designs_per_s", "threads", "tool_version", "platform", "tool", "files"}
# Keys of JSON whose strings are sentences for people: their words may change, the numbers in them may not.
SENTENCE_KEYS = {"question", "notes", "constraints", "reading", "reason", "reasons", "description", "separates", "follows", "why",
                 "words", "what"}

# How a file is compared, by the end of its name.
KINDS = {".csv": "csv", ".json": "json", ".md": "text", ".html": "text", ".svg": "text", ".txt": "text"}

LONGEST_SHOWN = 300
FIRST_OF_A_FILE = 40


@dataclass(frozen=True)
class Difference:
    """Something that is not the same. `fragment` is its text before and after as the allow-list takes it, if it may be there."""

    file: str
    place: str
    before: str
    after: str
    fragment: tuple = None


@dataclass
class Result:
    """What was compared, and what differs."""

    differences: list = field(default_factory=list)
    counts: Counter = field(default_factory=Counter)
    runs: str = ""

    def summary(self, took_s):
        c = self.counts
        kinds = ", ".join(f"{c[kind]} {kind}" for kind in sorted(k for k in c if k.startswith(".")))
        return (f"{c['commands']} commands ({self.runs}): {c['files']} files ({kinds}) and {2 * c['commands']} streams compared: "
                f"{c['csv bytes']:,} bytes of CSV, {c['values']:,} values of JSON, {c['numbers']:,} numbers in text; "
                f"{c['allowed']} files differ as allowed, {c['sentences']} sentences of JSON only in words; "
                f"{len(self.differences)} differences, in {took_s:.0f} s")


def compare_all(plan, before, after, allowed):
    """Everything that the commands of the plan gave."""
    result = Result(runs=f"{before.ran} run before and {before.kept} kept, {after.ran} run after and {after.kept} kept")
    for command in plan:
        folders = [before.folder(command), after.folder(command)]
        result.counts["commands"] += 1
        Pair(command.name + "/exit", folders, "exit", "exact", allowed, result).compare()
        Pair(command.name + "/stderr", folders, "stderr", "text", allowed, result).compare()
        failed = (folders[0] / "exit").read_text() != "0\n"
        Pair(command.name + "/stdout", folders, "stdout", "text" if failed else command.kind, allowed, result).compare()
        for name in sorted(set(written(folders[0])) | set(written(folders[1]))):
            suffix = "." + name.rsplit(".", 1)[-1]
            kind = KINDS.get(suffix, "exact")
            result.counts["files"] += 1
            result.counts[suffix] += 1
            Pair(f"{command.name}/{name}", folders, f"out/{name}", kind, allowed, result).compare()
    return result


def written(folder):
    """Names of the files that a command wrote; a single file that --out names is in a folder all the same."""
    out = folder / "out"
    return [str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()]


class Pair:
    """One output of both builds."""

    def __init__(self, file, folders, path, kind, allowed, result):
        self.file, self.kind, self.allowed, self.result = file, kind, allowed, result
        self.paths = [folder / path for folder in folders]
        self.work = [(folder / "work").read_text().strip() for folder in folders]

    def compare(self):
        missing = [name for name, path in zip(["before", "after"], self.paths) if not path.is_file()]
        if missing:
            self.differs(self.file, *("missing" if name in missing else "there" for name in ["before", "after"]))
            return
        before, after = (path.read_bytes() for path in self.paths)
        getattr(self, self.kind)(before, after)

    def differs(self, place, before, after, fragment=None):
        self.result.differences.append(Difference(self.file, place, before, after, fragment))

    def with_markers(self, text, side):
        return self.allowed.apply(text, side, self.file)

    def exact(self, before, after):
        if before != after:
            self.differs(self.file, *(shown(data.decode(errors="replace").strip()) for data in (before, after)))

    def csv(self, before, after):
        """Byte for byte, but for what is allowed."""
        self.result.counts["csv bytes"] += len(before)
        if before == after:
            return
        texts = [self.with_markers(data.decode(errors="replace"), side) for data, side in [(before, "before"), (after, "after")]]
        if texts[0] == texts[1]:
            self.result.counts["allowed"] += 1
            return
        rows = [text.splitlines() for text in texts]
        if len(rows[0]) != len(rows[1]):
            self.differs(f"{self.file}: rows", str(len(rows[0])), str(len(rows[1])))
        unequal = [(i, a, b) for i, (a, b) in enumerate(zip(*rows), 1) if a != b]
        for i, a, b in unequal[:FIRST_OF_A_FILE]:
            start, ends = unequal_part(a, b)
            fragment = tuple(line[slice(*around(line, start, end))] for line, end in zip((a, b), ends))
            self.differs(f"{self.file}:{i}", *(shown(part) for part in fragment), fragment)
        self.rest(len(unequal))
        if not unequal and len(rows[0]) == len(rows[1]):
            self.differs(f"{self.file}: line ends", repr(texts[0][-1:]), repr(texts[1][-1:]))

    def json(self, before, after):
        """As values."""
        try:
            values = [json.loads(data) for data in (before, after)]
        except ValueError as fault:
            self.differs(f"{self.file}: not JSON: {fault}", *(shown(data.decode(errors="replace")) for data in (before, after)))
            return
        found = list(self.unequal_values("$", "", *values))
        for place, a, b, fragment in found[:FIRST_OF_A_FILE]:
            self.differs(f"{self.file} {place}", shown(a), shown(b), fragment)
        self.rest(len(found))

    def rest(self, count):
        if count > FIRST_OF_A_FILE:
            self.differs(f"{self.file}: further differences", f"{count - FIRST_OF_A_FILE}", "not listed")

    def unequal_values(self, place, key, a, b):
        """Places in two JSON values, under a key, that are not equal."""
        if isinstance(a, dict) and isinstance(b, dict):
            for name in [*a, *(name for name in b if name not in a)]:
                if name in IGNORED_KEYS:
                    continue
                if name not in a or name not in b:
                    values = (json.dumps(value[name]) if name in value else "missing" for value in (a, b))
                    yield (f"{place}.{name}", *values, None)
                else:
                    yield from self.unequal_values(f"{place}.{name}", name, a[name], b[name])
        elif isinstance(a, list) and isinstance(b, list):
            if len(a) != len(b):
                yield f"{place}: length", str(len(a)), str(len(b)), None
            for i, (c, d) in enumerate(zip(a, b)):
                yield from self.unequal_values(f"{place}[{i}]", key, c, d)
        else:
            self.result.counts["values"] += 1
            if isinstance(a, str) and isinstance(b, str):
                yield from self.unequal_strings(place, key, a, b)
            elif isinstance(a, bool) is not isinstance(b, bool) or a != b:
                yield place, json.dumps(a), json.dumps(b), None

    def unequal_strings(self, place, key, a, b):
        """Two strings: a sentence by its numbers, else all of it."""
        if a == b:
            return
        if a.replace(self.work[0], "WORK") == b.replace(self.work[1], "WORK"):
            return
        marked = self.with_markers(a, "before"), self.with_markers(b, "after")
        if marked[0] == marked[1]:
            self.result.counts["allowed"] += 1
        elif key in SENTENCE_KEYS and words(numbers(marked[0])) == words(numbers(marked[1])):
            self.result.counts["sentences"] += 1
        else:
            yield place, a, b, (a, b)

    def text(self, before, after):
        """The sequence of numbers."""
        texts = [masked(data.decode(errors="replace"), work) for data, work in zip((before, after), self.work)]
        found = [numbers(text) for text in texts]
        self.result.counts["numbers"] += len(found[0])
        if words(found[0]) == words(found[1]):
            return
        texts = [self.with_markers(text, side) for text, side in zip(texts, ["before", "after"])]
        pieces = unequal_pieces(texts)
        if not pieces:
            self.result.counts["allowed"] += 1
        for spans in pieces[:FIRST_OF_A_FILE]:
            lines = [text.count("\n", 0, start) + 1 for text, (start, _) in zip(texts, spans)]
            place = f"{self.file}:{lines[0]}" + (f" (after: {lines[1]})" if lines[0] != lines[1] else "")
            parts = tuple(text[start:end].strip() for text, (start, end) in zip(texts, spans))
            self.differs(place, *(shown(part) or "(nothing)" for part in parts), parts)
        self.rest(len(pieces))


def unequal_part(a, b):
    """Where two lines begin to differ, and where that ends in either."""
    start = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
    tail = next((i for i, (x, y) in enumerate(zip(reversed(a), reversed(b))) if x != y), min(len(a), len(b)))
    tail = min(tail, len(a) - start, len(b) - start)
    return start, (len(a) - tail, len(b) - tail)


def shown(text):
    """A text on one line, cut if it is long."""
    line = " ".join(text.split())
    return line if len(line) <= LONGEST_SHOWN else line[:LONGEST_SHOWN] + " ..."
