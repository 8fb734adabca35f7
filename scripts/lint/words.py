"""Words that are never right for a program: a node, a packet or a function is "it", never "who".

It checks comments and texts, not names: in C++ the text after //, without `code`, and in quotes, in Python comments and
strings, in other files whole lines without `code`.
"""

import io
import re
import tokenize

from files import ROOT, all_files

WRONG = re.compile(r"\b(who|whom|whoever|nobody|told)\b", re.IGNORECASE)
# People may be "who".
PEOPLE = re.compile(
    r"\b(people|persons?|users?|readers?|authors?|researchers?|engineers?|students?|newcomers?"
    r"|anybody|somebody|everybody|team)\b,? (who|whom)\b",
    re.IGNORECASE,
)
ADVICE = "a program is \"it\": name what does it"
QUOTES_THEM = ("scripts/lint/words.py", "src/stg_bringup/test/test_architecture.py")
PROSE = {".md", ".launch", ".msg", ".srv", ".test", ".xml", ".yaml"}
QUOTED = re.compile(r'"((?:[^"\\]|\\.)*)"')


def _cpp_texts(text):
    """Yields (line number, text) of the comments and strings of C++."""
    for number, line in enumerate(text.splitlines(), start=1):
        code, slashes, comment = line.partition("//")
        if line.lstrip().startswith("#include"):
            continue
        if slashes and code.count('"') % 2 == 0:
            yield number, re.sub(r"`[^`]*`", "", comment)
        else:
            code = line
        for match in QUOTED.finditer(code):
            yield number, match.group(1)


def _python_texts(text):
    """Yields (line number, text) of the comments and strings of Python."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT or token.type == tokenize.STRING:
            for offset, line in enumerate(token.string.splitlines()):
                yield token.start[0] + offset, line


def _prose(text):
    """Yields (line number, text) outside of ``` and `code`."""
    fenced = False
    for number, line in enumerate(text.splitlines(), start=1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield number, re.sub(r"`[^`]*`", "", line)


def texts_of(name, text):
    """Yields (line number, text) of the texts for people in a file with this name."""
    suffix = name.suffix
    if suffix in (".cpp", ".hpp"):
        yield from _cpp_texts(text)
    elif suffix == ".py":
        yield from _python_texts(text)
    elif suffix in PROSE:
        yield from _prose(text)


def wrong_words(line):
    """Returns the words of a line that are never right for a program."""
    return [match.group(0) for match in WRONG.finditer(PEOPLE.sub("", line))]


def check_words(root=ROOT, files=None):
    """Finds words that are wrong for a program in `files`, which are paths from `root`."""
    findings, count = [], 0
    for path in all_files() if files is None else files:
        if files is None and path.as_posix() in QUOTES_THEM:
            continue
        count += 1
        try:
            text = (root / path).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue
        for number, line in texts_of(path, text):
            for word in wrong_words(line):
                findings.append(f"{path}:{number}: {word!r}: {ADVICE}")
    return f"{count} files", findings
