#!/usr/bin/env python3
"""mutate.py SEED FOLDER DRAW FILES...: one deterministic edit of the arithmetic in one of the files.

The draw picks a kind of edit, then one of the places in the files where that edit can be made; lines of memory and of
words are left out. The file is changed in place and the edit printed as a diff.
"""
import difflib
import random
import re
import sys

BESIDE = re.compile(r'sizeof|alloc|printf|error_set|palp_error|strcmp|strlen|memcpy|memset|assert')
LEFT, RIGHT = r'(?<=[\w)\]]) ', r' (?=[\w(&!*-])'
SWAPS = {'+': '-', '-': '+', '*': '/', '/': '*', '+=': '-=', '-=': '+=', '*=': '/=', '/=': '*=', '<': '>=', '>=': '<', '>': '<=',
         '<=': '>', '==': '!=', '!=': '==', 'fmax': 'fmin', 'fmin': 'fmax', 'sin': 'cos', 'cos': 'sin', 'exp': '-exp', 'sqrt': '',
         'fabs': '', 'log': '0.5 * log'}


def blanked(text):
    """The text with comments, strings and preprocessor lines as blanks, places kept."""
    blank = lambda m: re.sub(r'[^\n]', ' ', m.group())
    return re.sub(r'/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\])+\'|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*', blank, text, flags=re.S | re.M)


def bodies(text):
    """Spans of the function bodies."""
    for start in re.finditer(r'^[\w].*\) \{$', text, flags=re.M):
        end = text.find('\n}', start.end())
        if end > 0:
            yield start.end(), end


def operand_end(text, at, stops):
    """Where the operand that begins at `at` ends: before a stop or a closing bracket at its own depth."""
    depth = 0
    for i in range(at, len(text)):
        c = text[i]
        if depth == 0 and (c in ')],;?:{}' or any(text.startswith(s, i) for s in stops)):
            return i
        depth += (c in '([') - (c in ')]')
    return len(text)


def edits(text):
    """{kind: [(start, end, replacement)]} of one file."""
    code, found = blanked(text), {}
    add = lambda kind, start, end, new: found.setdefault(kind, []).append((start, end, new))
    sums = [' + ', ' - ', ' < ', ' > ', ' <= ', ' >= ', ' == ', ' != ', ' && ', ' || ']
    for first, last in bodies(code):
        part = code[:last]
        for m in re.compile(LEFT + r'([+\-*/])' + RIGHT).finditer(part, first):
            sign = m.group(1)
            add('sum' if sign in '+-' else 'product', m.start(1), m.end(1), SWAPS[sign])
            in_index = part.count('[', part.rfind('\n', 0, m.start()), m.start()) > part.count(']', part.rfind('\n', 0, m.start()), m.start())
            if sign in '+-':
                add('term', m.start(), operand_end(part, m.end(), sums), '')
            else:
                add('factor', m.start(), operand_end(part, m.end(), sums + [' * ', ' / ']), '')
                if not in_index:
                    add('half', m.end(1), m.end(1), ' 0.5 *' if sign == '*' else ' 2.0 /')
        for m in re.compile(LEFT + r'(<|>|<=|>=|==|!=)' + RIGHT).finditer(part, first):
            add('comparison', m.start(1), m.end(1), SWAPS[m.group(1)])
        for m in re.compile(LEFT + r'([+\-*/]=)' + RIGHT).finditer(part, first):
            add('assignment', m.start(1), m.end(1), SWAPS[m.group(1)])
        for m in re.compile(r'\b(fmax|fmin|sin|cos|exp|sqrt|fabs|log)(?=\()').finditer(part, first):
            add('function', m.start(1), m.end(1), SWAPS[m.group(1)])
        for m in re.compile(r'(?<=[(,=*/<>] )-(?=[\w(])|(?<=\()-(?=[a-z(])|(?<=return )-(?=[\w(])').finditer(part, first):
            add('sign', m.start(), m.end(), '')
        for m in re.compile(r'(?<![\w.])\d+\.\d+(e-?\d+)?(?![\w.])').finditer(part, first):
            if float(m.group()) != 0:
                add('constant', m.start(), m.end(), '(0.5 * %s)' % m.group())
    line = lambda at: code[code.rfind('\n', 0, at) + 1:code.find('\n', at)]
    return {kind: [e for e in all_ if not BESIDE.search(line(e[0]))] for kind, all_ in found.items()}


def main():
    seed, folder, draw, files = sys.argv[1], sys.argv[2], sys.argv[3], sys.argv[4:]
    texts = {f: open(f).read() for f in files}
    places = {}
    for f in sorted(files):
        for kind, found in edits(texts[f]).items():
            places.setdefault(kind, []).extend((f, e) for e in found)
    rng = random.Random('%s %s %s' % (seed, folder, draw))
    kinds = sorted(k for k in places if places[k])
    f, (start, end, new) = rng.choice(places[rng.choice(kinds)])
    old = texts[f]
    text = old[:start] + new + old[end:]
    with open(f, 'w') as to:
        to.write(text)
    sys.stdout.writelines(difflib.unified_diff(old.splitlines(True), text.splitlines(True), f, f, n=1))


if __name__ == '__main__':
    main()
