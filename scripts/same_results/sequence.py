"""Sets the numbers of two texts side by side and finds the pieces of text where they are not the same."""

from difflib import SequenceMatcher

from .text import numbers, words

# Of a line longer than this, a piece is taken with a few words to either side.
LONG_LINE = 150
AROUND = 60
# Above this many numbers, texts are set side by side by lines first.
MANY_NUMBERS = 3000


def unequal_pieces(texts):
    """Pieces of two texts that hold other numbers, as ((start, end), (start, end)); one of them may be empty.

    Within the texts, either piece stands for the other: what is left and right of them has the same numbers.
    """
    found = [numbers(text) for text in texts]
    pieces = []
    for runs in unequal_runs(texts, found):
        spans = spans_of(texts, found, runs)
        while pieces and any(spans[side][0] < pieces[-1][1][side][1] for side in (0, 1)):
            before, _ = pieces.pop()
            runs = tuple((old[0], new[1]) for old, new in zip(before, runs))
            spans = spans_of(texts, found, runs)
        pieces.append((runs, spans))
    return [balanced(found, runs, spans) for runs, spans in pieces]


def spans_of(texts, found, runs):
    """Where the runs stand in their texts, with what is around them."""
    return tuple(span(text, of, run) for text, of, run in zip(texts, found, runs))


def span(text, found, run):
    """The lines from a run's first number to its last; an empty run has no piece, and a place."""
    first, last = run
    if first < last:
        return around(text, found[first].start, found[last - 1].end)
    place = found[first].start if first < len(found) else len(text)
    return place, place


def around(text, start, end):
    """The lines of a piece of text; of long lines some words to either side."""
    line_start = text.rfind("\n", 0, start) + 1
    line_end = text.find("\n", end)
    line_end = line_end if line_end >= 0 else len(text)
    if start - line_start > LONG_LINE:
        blank = text.find(" ", start - AROUND, start)
        line_start = blank + 1 if blank >= 0 else start
    if line_end - end > LONG_LINE:
        blank = text.rfind(" ", end, end + AROUND)
        line_end = blank if blank >= 0 else end
    return line_start, line_end


def balanced(found, runs, spans):
    """Spans that hold equally many of the numbers before their runs, and equally many of those behind."""
    before = [sum(n.start >= start for n in of[max(0, run[0] - 200) : run[0]]) for of, run, (start, _) in zip(found, runs, spans)]
    behind = [sum(n.end <= end for n in of[run[1] : run[1] + 200]) for of, run, (_, end) in zip(found, runs, spans)]
    out = []
    for of, run, (start, end), p, q in zip(found, runs, spans, before, behind):
        if p < max(before):
            start = of[max(0, run[0] - max(before))].start
        if q < max(behind):
            end = of[min(len(of), run[1] + max(behind)) - 1].end
        out.append((start, max(start, end)))
    return tuple(out)


def unequal_runs(texts, found):
    """Runs of numbers, (first, last) in either text, that are not the same."""
    a, b = (words(of) for of in found)
    low = common(a, b)
    high = common(a[: low - 1 if low else None : -1], b[: low - 1 if low else None : -1])
    runs = [((low, len(a) - high), (low, len(b) - high))]
    if max(len(a), len(b)) - low - high > MANY_NUMBERS:
        runs = unequal_lines(texts, found, runs[0])
    for (a0, a1), (b0, b1) in runs:
        # very long runs have no time for words that come often, as they do in tables
        matcher = SequenceMatcher(None, a[a0:a1], b[b0:b1], autojunk=max(a1 - a0, b1 - b0) > MANY_NUMBERS)
        for tag, i0, i1, j0, j1 in matcher.get_opcodes():
            if tag != "equal":
                yield (a0 + i0, a0 + i1), (b0 + j0, b0 + j1)


def common(a, b):
    """How many elements two sequences have in common at their beginning."""
    return next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))


def unequal_lines(texts, found, runs):
    """The same by whole lines."""
    groups = [lines_of(text, of, run) for text, of, run in zip(texts, found, runs)]
    keys = [[tuple(words(of[i:j])) for i, j in lines] for lines, of in zip(groups, found)]
    starts = [[*(first for first, _ in lines), last] for lines, (_, last) in zip(groups, runs)]
    for tag, i0, i1, j0, j1 in SequenceMatcher(None, *keys, autojunk=False).get_opcodes():
        if tag != "equal":
            yield (starts[0][i0], starts[0][i1]), (starts[1][j0], starts[1][j1])


def lines_of(text, found, run):
    """The numbers of a run by lines, (first, last) of each line that has any."""
    lines, line_end = [], -1
    for i in range(*run):
        if found[i].start > line_end:
            end = text.find("\n", found[i].start)
            line_end = end if end >= 0 else len(text)
            lines.append((i, i))
        lines[-1] = (lines[-1][0], i + 1)
    return lines
