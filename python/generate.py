#!/usr/bin/env python3
"""generate.py: writes c.py, the whole C library for ctypes, from its headers.

    python3 generate.py FILE

Types come from lib/palpate.abi, where `make symbols` puts them with all macros expanded; functions, their
parameters and all comments come from include/palpate/*.h. The result belongs to the wheel, not to the repository."""
import ctypes
import glob
import keyword
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SCALARS = {'double': 'c_double', 'float': 'c_float', '_Bool': 'c_bool', 'bool': 'c_bool', 'int': 'c_int',
           'size_t': 'c_size_t', 'char': 'c_char', 'unsigned char': 'c_ubyte', 'FILE': 'c_void_p',
           'int16_t': 'c_int16', 'int32_t': 'c_int32', 'uint8_t': 'c_uint8', 'uint16_t': 'c_uint16',
           'uint32_t': 'c_uint32', 'uint64_t': 'c_uint64'}
# Numbers of elements that neither a comment "[n]" after a member nor a member n_<its name> tells.
LENGTHS = {'palp_forward_run': {'time_s': 'n', 'depth_m': 'n'},
           'palp_law': {'coefficients': 'n', 'strain': 'n', 'slope': 'n', 'energy': 'n'},
           'palp_path': {'time_s': 'n', 'depth_m': 'n', 'force_N': 'n'},
           'palp_recording': {'time_s': 'n', 'depth_m': 'n', 'force_N': 'n'},
           'palp_retardation': {'compliance_1_Pa': 'n', 'time_s': 'n'},
           'palp_moduli': {'arm_Pa': 'n_arms', 'tau_s': 'n_arms'},
           'palp_solid': {'tau_s': 'n_arms', 'share': 'n_arms'},
           'palp_solid_press': {'time_s': 'n', 'depth_m': 'n', 'force_N': 'n', 'use': 'n'},
           'palp_model': {'validity': 'n_validity'},
           'palp_explain_effect': {'alike': 'n_class'},
           'palp_effect_info': {'alike': 'n_alike'}}


COMMENT = r'/\*(?:[^*]|\*(?!/))*\*/'


def plain(comment):
    """The text of C comments on one line each."""
    lines = re.sub(r'/\*|\*/', ' ', comment).split('\n')
    return ' '.join(' '.join(re.sub(r'^\s*\*\s?', '', line) for line in lines).split())


def split(text, at):
    """Parts of text between the characters at, outside of brackets and comments."""
    parts, depth, part = [], 0, ''
    for token in re.findall(r'/\*.*?\*/|.', text, re.S):
        depth += (token in '{([') - (token in '})]') if len(token) == 1 else 0
        if token == at and depth == 0:
            parts.append(part)
            part = ''
        else:
            part += token
    return parts + [part]


def member_docs(body):
    """The comment of each member of a structure: beside it, or on lines of its own above it."""
    docs, members, above, fresh = {}, [], '', True
    for token in re.findall(COMMENT + r'|[^;/\n][^;/]*;|\n', body):
        if token == '\n':
            fresh = True
        elif not token.startswith('/*'):
            members = [m[1] for part in split(token[:-1], ',')
                       if (m := re.search(r'(\w+)(?:\[[^\]]*\])*\)?(?:\([^)]*\))?\s*$', part))]
            docs.update((member, above) for member in members)
            above, fresh = '', False
        elif fresh:
            above = plain(token)
        else:
            docs.update((member, (docs[member] + ' ' + plain(token)).strip()) for member in members)
    return docs


class Generator:
    def __init__(self):
        self.abi = open(os.path.join(ROOT, 'lib/palpate.abi')).read().split('\n')
        self.headers = {os.path.basename(f): open(f).read()
                        for f in sorted(glob.glob(os.path.join(ROOT, 'include/palpate/*.h')))}
        self.constants, self.enums, self.structs, self.callbacks, self.opaque = {}, {}, {}, {}, []
        self.functions = {}
        self.aliases = dict(SCALARS)
        self.used_lengths = set()
        self.docs = self.read_docs()
        for line in self.abi:
            self.read_type(line)

    # ---- what the headers say ----

    def read_docs(self):
        """The comment before or beside each typedef and function, and beside each member."""
        docs = {}
        pattern = r'(%s\n)?typedef (?:struct|enum) (\w+)( \{(.*?)\n?\} \2)?;([^\n]*)' % COMMENT
        for text in self.headers.values():
            for before, name, _, body, beside in re.findall(pattern, text, re.S):
                docs[name] = plain(before + ' '.join(re.findall(COMMENT, beside)))
                docs.update(((name, member), doc) for member, doc in member_docs(body).items())
        return docs

    def read_functions(self):
        pattern = re.compile(r'((?:%s\n)?)PALP_API ([^;(]*?)(\w+)\(([^;]*)\);([^\n]*)' % COMMENT)
        for text in self.headers.values():
            last, end = '', -9
            for match in pattern.finditer(text):
                before, result, name, parameters, beside = match.groups()
                together = text[end:match.start()].count('\n') <= 1  # a group below one comment
                comment = before if before.strip() else last if together else ''
                last, end = comment, match.end()
                doc = plain(comment + ' ' + ' '.join(re.findall(COMMENT, beside)))
                self.functions[name] = (result.strip(), [' '.join(p.split()) for p in split(parameters, ',')], doc)

    # ---- types ----

    def read_type(self, line):
        if match := re.match(r'(?:typedef )?enum (\w* ?){ (.*?),? }', line):
            self.read_enum(match[1].strip(), match[2])
        elif match := re.match(r'typedef struct (\w+) { (.*) } \1;$', line):
            self.structs[match[1]] = match[2]
            self.aliases[match[1]] = match[1]
        elif match := re.match(r'typedef struct (\w+) \1;$', line):
            self.opaque.append(match[1])
            self.aliases[match[1]] = match[1]
        elif match := re.match(r'typedef (\w+) (\w+);$', line):
            self.aliases[match[2]] = SCALARS[match[1]]
        elif match := re.match(r'typedef (\w+) \(?\*?(\w+)\)?\((.*)\);$', line):
            self.aliases[match[2]] = match[2]
            self.callbacks[match[2]] = (match[1], split(match[3], ','))

    def read_enum(self, name, body):
        members, value = [], -1
        for part in split(body, ','):
            member, _, given = (p.strip() for p in part.partition('='))
            value = self.number(given) if given else value + 1
            self.constants[member] = value
            members.append((member, value))
        if name:
            self.enums[name] = members
            self.aliases[name] = name

    def number(self, expression):
        return eval(expression, {}, dict(self.constants))

    def ctype(self, text, parameter=False):
        """A declaration without its name, as a ctypes expression."""
        if match := re.match(r'(.+?)\(\*\w*\)\((.*)\)$', text):  # a pointer to a function
            return self.callback(match[1].strip(), split(match[2], ','))
        base = re.sub(r'\bconst\b|\bstruct\b|\[[^\]]*\]|\*', ' ', text)
        base = ' '.join(base.split())
        stars = text.count('*') + (text.count('[') if parameter else 0)
        constant = text.startswith('const ')
        if base == 'void':
            return 'None' if not stars else f'Array(c_void_p, {constant})' if parameter else 'c_void_p'
        name = self.aliases.get(base, 'c_void_p')
        if name == 'c_void_p' or name in self.callbacks:
            return name
        if name == 'c_char' and stars:
            first = 'Text' if parameter and constant and stars == 1 else 'c_char_p'
            return 'POINTER(' * (stars - 1) + first + ')' * (stars - 1)
        if not stars:
            return name
        if name in self.enums:
            name = 'c_int'
        if parameter and stars == 1 and name.startswith('c_'):
            return f'Array({name}, {constant})'
        return 'POINTER(' * stars + name + ')' * stars

    def callback(self, result, parameters):
        arguments = [self.ctype(self.unnamed(p)) for p in parameters if p.strip()]
        arguments = [a if a not in self.enums else 'c_int' for a in arguments]
        return 'CFUNCTYPE(%s)' % ', '.join([self.ctype(result)] + arguments)

    def unnamed(self, parameter):
        """A parameter without its name; an array as a pointer."""
        parameter = re.sub(r'\[[^\]]*\]', ' *', parameter.strip()) if '(*' not in parameter else parameter
        known = re.sub(r'\b(const|unsigned|struct)\b|\*', ' ', parameter).split()
        if len(known) > 1 and '(*' not in parameter:
            parameter = re.sub(r'\b%s\b' % known[-1], '', parameter)
        return parameter.strip()

    def members(self, struct):
        """(name, type as an expression, shape or None) of each member."""
        for part in split(self.structs[struct].strip(), ';'):
            part = part.strip()
            if not part:
                continue
            if match := re.match(r'union { (.*) } (\w+)$', part):
                self.structs[struct + '_' + match[2]] = match[1]
                yield match[2], struct + '_' + match[2], None
            elif match := re.match(r'(.+?)\(\*(\w+)\)(\(.*\))$', part):
                yield match[2], self.ctype(f'{match[1]}(*){match[3]}'), None
            else:
                yield from self.declared(struct, part)

    def declared(self, struct, part):
        base, rest = re.match(r'((?:const |struct |unsigned )*\w+) ?(.*)$', part).groups()
        for declarator in split(rest, ','):
            stars, name, array = re.match(r'\s*([*\s]*)(?:const )?(\w+)((?:\[[^\]]*\])*)', declarator).groups()
            kind = self.ctype(base + ' ' + stars)
            for size in reversed(re.findall(r'\[([^\]]*)\]', array)):
                kind = f'{kind} * {self.number(size)}' if kind not in self.enums else f'({kind}, {self.number(size)})'
            yield name, kind, self.shape(struct, name, kind)

    def shape(self, struct, name, kind):
        """Of what POINTER or array members point to: factors, each a path to a member or a number."""
        if not (kind.startswith('POINTER(') or '*' in kind or kind.startswith('(')) or 'c_char' in kind:
            return None
        length = LENGTHS.get(struct, {}).get(name)
        self.used_lengths.add((struct, name) if length else None)
        comment = re.match(r'\[([^\]]+)\]', self.docs.get((struct, name), ''))
        names = re.findall(r'(\w+)(?:\[[^\]]*\])*\s*(?=[,;])', self.structs[struct] + ';')
        if not length and comment:
            length = re.sub(r'(\S+)\^2', r'\1 \1', comment[1])
        for guess in ('n_' + name, 'n_' + name + 's'):
            length = length or (guess if guess in names else None)
        factors = (length or '').split()
        return tuple(factors) if factors and all(re.match(r'\d+$', f) or f.split('.')[0] in names for f in factors) else None

    # ---- the result ----

    def order(self):
        """Structures, each after those that it holds."""
        done, fields = [], {}

        def visit(struct):
            if struct in done:
                return
            fields[struct] = list(self.members(struct))
            for _, kind, _ in fields[struct]:
                for used in re.findall(r'palp_\w+', kind):
                    if used in self.structs and not kind.startswith(('POINTER', 'CFUNCTYPE')):
                        visit(used)
            done.append(struct)
        for struct in sorted(self.structs):
            visit(struct)
        return [(struct, fields[struct]) for struct in done]

    def write(self, out):
        version = re.search(r'define PALP_VERSION "(.*)"', self.headers['version.h'])[1]
        out.write('"""The C library, function by function; made by generate.py from its headers."""\n')
        out.write('from ctypes import *\n\n')
        out.write('from ._base import Array, Choice, Enum, Error, Opaque, Record, Text, complete, function, load\n\n')
        out.write(f'VERSION = {version!r}\nload({self.abi[0].split()[1]!r}, VERSION)\n\n')
        for name, members in self.enums.items():
            out.write(f'class {name}(Enum):\n    {self.docs.get(name, "")!r}\n')
            out.write(''.join(f'    {member} = {value}\n' for member, value in members) + '\n')
        for text in self.headers.values():
            for name, value in re.findall(r'^#define (PALP_\w+) ([0-9.]+)$', text, re.M):
                self.constants[name] = float(value) if '.' in value else int(value)
            for name in re.findall(r'^#define (PALP_\w+) \(\(size_t\)-1\)$', text, re.M):
                self.constants[name] = ctypes.c_size_t(-1).value
        out.write(''.join(f'{name} = {value}\n' for name, value in self.constants.items()
                          if not any(name in dict(m) for m in self.enums.values())))
        out.write(''.join(f'{name} = {enum}.{name}\n' for enum, m in self.enums.items() for name, _ in m) + '\n')
        structs = self.order()
        for name in self.opaque + [name for name, _ in structs]:
            kind = 'Record' if name in self.structs and not name.endswith('_as') else 'Choice' if name in self.structs else 'Opaque'
            out.write(f'class {name}({kind}):\n    {self.docs.get(name, "")!r}\n    __slots__ = ()\n\n')
        out.write(''.join(f'{name} = {self.callback(*kinds)}\n' for name, kinds in self.callbacks.items()))
        for name, fields in structs:
            out.write(f'complete({name}, [\n')
            for member, kind, shape in fields:
                doc = self.docs.get((name, member), '')
                member += '_' if keyword.iskeyword(member) else ''
                out.write(f'    ({member!r}, {kind}, {shape!r}, {doc!r}),\n')
            out.write('])\n')
        self.read_functions()
        for name, (result, parameters, doc) in self.functions.items():
            kinds = [self.ctype(self.unnamed(p), True) for p in parameters if p != 'void']
            signature = f'{result} {name}({", ".join(parameters)})'.replace('* ', '*')
            out.write(f'{name} = function({name!r}, {self.ctype(result)}, [{", ".join(kinds)}],\n    {signature!r},\n    {doc!r})\n')
        unused = {(s, m) for s in LENGTHS for m in LENGTHS[s]} - self.used_lengths
        listed = set(re.findall(r'^(?!typedef).*?\b(palp_\w+)\(', '\n'.join(self.abi), re.M))
        if unused or listed != set(self.functions):
            sys.exit(f'generate.py: lengths without a member: {unused}; functions of one list: {listed ^ set(self.functions)}')


if __name__ == '__main__':
    with open(sys.argv[1], 'w') as file:
        Generator().write(file)
