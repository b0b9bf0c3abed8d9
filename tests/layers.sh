#!/bin/sh
# layers.sh: a folder is a layer and uses only those below it. Fails on an include or a symbol (nm of the objects
# under build/obj) that goes up, on a public header that declares what another layer defines, and on a cycle
# between the files of a folder. With --self-test it shows that it finds each of these.
#   tests/layers.sh [--self-test]       BUILD names the build's folder
set -eu
cd "$(dirname "$0")/.."
BUILD=${BUILD:-build}

# layer: what it may use, beside itself and what those use | the public headers of its concepts
layers() {
    cat <<'TABLE'
base: | export version status file path random
wire: base | wire
solve: base | solver
material: base | law material closed_form indentation
mesh: base | mesh
data: base | experiment recording segments
effect: wire solve material mesh data | effect
model: effect | model region free_term
network: model | network visual vtu
contact: network | tool tie
cut: network | cut
realtime: contact cut | realtime
reduce: realtime | reduce sim
response: network | forward specimen
ranks: network | ranks
fit: data response realtime | characterize calibrate moduli spectrum palpation solid
explain: response fit data | explain
thesis: fit | thesis
palpate.h: thesis explain fit response ranks reduce realtime | palpate
firmware/core: wire |
firmware/board: firmware/core |
tools/shared: |
tools/indenter: |
tools/rig: tools/shared firmware/board |
tools/acquire: tools/indenter tools/rig |
tools/panel: tools/acquire |
tools/calibrate_device: tools/acquire |
tools/report: tools/explain |
tools/firmware: tools/indenter tools/rig |
tools/*: tools/shared |
tools: tools/* |
TABLE
}
# Tools use of the library what the public headers declare. What hal.h asks for, hal_*, every board gives.

sources() { find lib tools firmware include -name '*.[ch]' | LC_ALL=C sort; }
objects() { find lib tools firmware/core firmware/board -maxdepth 2 -name '*.c' | LC_ALL=C sort; }

includes() { # "include FILE TARGET", the target as a path from the root
    { sources; sources | xargs grep -H '^# *include *["<]'; } | awk '
        !/#/ { exists[$0] = 1; next }
        {
            match($0, /[<"][^>"]*/); name = substr($0, RSTART + 1, RLENGTH - 1)
            file = $0; sub(/:.*/, "", file); folder[1] = file; sub(/\/[^\/]*$/, "", folder[1])
            n = 1 + split("include lib tools firmware/core firmware/board", other, " ")
            for (i = 2; i <= n; i++) folder[i] = other[i - 1]
            for (i = 1; i <= n; i++) {
                target = folder[i] "/" name
                while (sub(/[^\/.]+\/\.\.\//, "", target)) { }
                if (target in exists) { print "include", file, target; break }
            }
        }'
}

symbols() { # "has FILE SYMBOL", "uses FILE SYMBOL"; "unbuilt FILE" for a source without an object, those of boards and
# of the other way to build lib/ranks/ aside
    objects | while read -r file; do
        if [ -e "$BUILD/obj/${file%.c}.o" ]; then
            echo "$BUILD/obj/${file%.c}.o"
        else
            case $file in firmware/board/* | lib/ranks/*) ;; *) echo "unbuilt $file" ;; esac
        fi
    done >"$work/objects"
    grep '^unbuilt' "$work/objects" || true
    grep -v '^unbuilt' "$work/objects" | xargs nm -A | awk -v skip="${#BUILD}" '{
        file = substr($1, skip + 6); sub(/\.o:.*/, ".c", file)
        if ($(NF - 1) == "U") print "uses", file, $NF
        else if ($(NF - 1) ~ /^[A-TV-Z]$/) print "has", file, $NF
    }'
}

declared() { # "public HEADER FUNCTION"
    for header in include/palpate/*.h; do
        tr '\n' ' ' <"$header" | grep -o 'PALP_API [^;(]*(' | sed -n "s,.*\(palp_[a-z0-9_]*\)(\$,public $header \1,p"
    done
}

judge() { # facts on standard input
    awk '
    function place(file,   part, n) { # the layer of a file
        if (file in header_layer) return header_layer[file]
        n = split(file, part, "/")
        if (part[1] == "include") return "no layer"
        if (part[1] == "lib") return part[2]
        if (part[1] == "firmware") return part[2] == "core" ? "firmware/core" : "firmware/board"
        return n > 2 ? "tools/" part[2] : "tools"
    }
    function row(layer) { return !(layer in known) && layer ~ /^tools\// ? "tools/*" : layer }
    function below(upper, lower,   i, n, list) { # whether upper may use lower
        if (upper == lower || index(" " direct[row(upper)] " ", " " lower " ")) return 1
        if (upper == "tools" && lower ~ /^tools\//) return 1
        n = split(direct[row(upper)], list, " ")
        for (i = 1; i <= n; i++) if (list[i] != "tools/*" && below(list[i], lower)) return 1
        return 0
    }
    function fail(text) { if (!(text in said)) { said[text] = 1; print text; failed++ } }
    function upward(from, to, what,   a, b) {
        a = place(from); b = place(to)
        if (b == "no layer") { fail(to " is in no layer: name it in tests/layers.sh"); return }
        if (!below(a, b)) fail(from " " what ": " a " may not use " b)
    }
    function reaches(from, goal,   i, n, list) { # along the edges between files
        if (from == goal) return 1
        if (from in seen) return 0
        seen[from] = 1
        n = split(next_of[from], list, " ")
        for (i = 1; i <= n; i++) if (reaches(list[i], goal)) return 1
        return 0
    }
    function edge(from, to, why) {
        if (from == to || ((from, to) in reason)) return
        reason[from, to] = why; next_of[from] = next_of[from] " " to
        edges++; edge_from[edges] = from; edge_to[edges] = to
    }
    $1 == "layer" {
        name = $2; sub(/:$/, "", name); known[name] = 1
        for (i = 3; $i != "|"; i++) direct[name] = direct[name] " " $i
        for (i++; i <= NF; i++) header_layer["include/palpate/" $i ".h"] = name
    }
    $1 == "include" { n_include++; include_from[n_include] = $2; include_to[n_include] = $3 }
    $1 == "has" { owner[$3] = $2; files[$2] = 1 }
    $1 == "uses" { n_use++; use_from[n_use] = $2; use_of[n_use] = $3; files[$2] = 1 }
    $1 == "public" { public[$3] = $2 }
    $1 == "unbuilt" { fail($2 " is not built: make") }
    END {
        for (i = 1; i <= n_include; i++) {
            from = include_from[i]; to = include_to[i]
            if (from ~ /^tools/ && to ~ /^include/) continue
            upward(from, to, "includes " to)
            if (from ~ /\.h$/ && to ~ /\.h$/) edge(from, to, "includes it")
        }
        for (i = 1; i <= n_use; i++) {
            from = use_from[i]; symbol = use_of[i]
            if (!(symbol in owner) || owner[symbol] == from || symbol ~ /^hal_/) continue
            to = owner[symbol]
            if (!(from ~ /^tools/ && to ~ /^lib/ && symbol in public)) upward(from, to, "uses " symbol " of " to)
            if (place(from) == place(to)) edge(from, to, "uses its " symbol)
        }
        for (symbol in public) if (symbol in owner && place(public[symbol]) != place(owner[symbol]))
            fail(public[symbol] " declares " symbol " of " owner[symbol] ": " place(public[symbol]) " is not " place(owner[symbol]))
        for (i = 1; i <= edges; i++) {
            for (f in seen) delete seen[f]
            if (reaches(edge_to[i], edge_from[i]))
                fail("cycle: " edge_from[i] " needs " edge_to[i] ": " reason[edge_from[i], edge_to[i]])
        }
        n = 0; for (f in files) n++
        if (!n || !n_include) fail("nothing was looked at")
        if (failed) { print failed " violations"; exit 1 }
        print n " objects and " n_include " includes obey the layers"
    }'
}

self_test() { # a small tree with one violation of each kind, and the lines that name them
    mkdir -p "$work/tests" "$work/lib/base" "$work/lib/network" "$work/include/palpate" "$work/tools/shared" "$work/tools/one" \
        "$work/tools/two" "$work/firmware/core" "$work/firmware/board"
    cp tests/layers.sh "$work/tests"
    cd "$work"
    echo 'PALP_API int palp_network_one(void); PALP_API int palp_status_high(void);' >include/palpate/status.h
    : >include/palpate/odd.h
    echo '#include "lib/base/two.h"' >lib/base/one.h
    echo '#include "lib/base/one.h"' >lib/base/two.h
    sed -i 's,lib/base/,,' lib/base/*.h
    printf '#include "palpate/odd.h"\nint palp_network_one(void); int base_low(void); int base_low(void) { return palp_network_one(); }\n' >lib/base/low.c
    echo 'int b(void); int a(void); int a(void) { return b(); }' >lib/network/a.c
    echo 'int a(void); int b(void); int b(void) { return a(); }' >lib/network/b.c
    echo 'int palp_network_one(void); int palp_network_one(void) { return 1; }' >lib/network/one.c
    : >lib/network/one.h
    echo 'int base_low(void); int palp_network_one(void); int tool(void); int tool(void) { return base_low() + palp_network_one(); }' >tools/one/one.c
    printf '#include "network/one.h"\nint tool(void); int two(void); int two(void) { return tool(); }\n' >tools/two/two.c
    echo '#include "../two/two.h"' >tools/shared/shared.h
    : >tools/two/two.h
    echo '#include "board.h"' >firmware/core/core.c
    : >firmware/board/board.h
    for f in lib/*/*.c tools/*/*.c firmware/core/*.c; do
        mkdir -p "build/obj/${f%/*}"
        ${CC:-cc} -Iinclude -Ifirmware/board -Ilib -c -o "build/obj/${f%.c}.o" "$f"
    done
    cat >expected <<'LINES'
13 violations
cycle: lib/base/one.h needs lib/base/two.h: includes it
cycle: lib/base/two.h needs lib/base/one.h: includes it
cycle: lib/network/a.c needs lib/network/b.c: uses its b
cycle: lib/network/b.c needs lib/network/a.c: uses its a
firmware/core/core.c includes firmware/board/board.h: firmware/core may not use firmware/board
include/palpate/odd.h is in no layer: name it in tests/layers.sh
include/palpate/status.h declares palp_network_one of lib/network/one.c: base is not network
lib/base/late.c is not built: make
lib/base/low.c uses palp_network_one of lib/network/one.c: base may not use network
tools/one/one.c uses base_low of lib/base/low.c: tools/one may not use base
tools/shared/shared.h includes tools/two/two.h: tools/shared may not use tools/two
tools/two/two.c includes lib/network/one.h: tools/two may not use network
tools/two/two.c uses tool of tools/one/one.c: tools/two may not use tools/one
LINES
    : >lib/base/late.c
    if BUILD=build sh tests/layers.sh >found; then echo "the planted violations were not found"; exit 1; fi
    LC_ALL=C sort found | diff -u expected - || { echo "not what was planted"; exit 1; }
    echo "the planted violations were found"
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ "${1-}" = --self-test ]; then self_test; exit; fi
{ layers | sed 's/^/layer /'; includes; symbols; declared; } | judge
