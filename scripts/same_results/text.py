"""The numbers of a text that is read by people, and what of it is left out."""

import re
from dataclasses import dataclass

# Left out of every text: [pattern, what takes its place]. A pattern's line breaks stay, so that lines keep their numbers.
MASKS = [
    # progress on standard error, a line every ten seconds: "10 s: 3.173e5 boxes", "20 s: 1.2e6 of 3.4e7 designs (4 %), ..."
    (r"(?m)^\d+ s: [\d.e]+ (?:boxes|of )[^\n]*$", ""),
    # "..., in 6.92 s (1,216,820 designs/s on 2 threads); search complete." and "..., in 228 s; search certified."
    (r"\bin\s+[\d.,e-]+\s+s(?=\s*[;(])", "in ELAPSED"),
    (r"\([\d.,e]+\s+designs/s(?:\s+on\s+\d+\s+threads?)?\)", "(RATE)"),
    # the facts of the run on a page: <dt>elapsed s</dt><dd>6.92</dd>
    (r"(<dt>(?:elapsed|designs per|threads|tool version|platform)[^<]*</dt>\s*<dd>)[^<]*", r"\1"),
    # "armwright 0.1.0": the version
    (r"\barmwright \d+\.\d+\.\d+\S*", "armwright VERSION"),
]
MASKS = [(re.compile(pattern), instead) for pattern, instead in MASKS]

# A word of letters, digits and dots, with its sign; or dots of a chart, blank ones first left out.
WORD = re.compile(r"(?:(?<![A-Za-z0-9_.])[-+\u2212])?[A-Za-z0-9_.]+|[\u2801-\u28ff][\u2800-\u28ff]*|\u27e6\d+\u27e7")
DIGIT_OR_DOTS = re.compile(r"[0-9\u2801-\u28ff]")


@dataclass(frozen=True)
class Number:
    """A number, or a word with a digit in it, and where it stands."""

    word: str
    start: int
    end: int


def masked(text, work):
    """The text without what may differ from run to run."""
    for name in {work, work.replace("/", "&#x2f;")}:
        text = text.replace(name, "WORK")
    for pattern, instead in MASKS:
        text = pattern.sub(lambda match: keeping_lines(match.group(), match.expand(instead)), text)
    return text


def keeping_lines(old, new):
    """New text with as many line ends as the old."""
    return new + "\n" * (old.count("\n") - new.count("\n"))


def numbers(text):
    """Every number of a text, in order."""
    found = []
    for match in WORD.finditer(text):
        word = match.group()
        if DIGIT_OR_DOTS.search(word):
            found.append(Number(word.strip(".").lower().replace("\u2212", "-").rstrip("\u2800"), match.start(), match.end()))
    return found


def words(found):
    return [number.word for number in found]
