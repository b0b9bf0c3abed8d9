# stack.awk: the deepest stack of the firmware, from gcc's -fcallgraph-info=su.
#   awk -v root=reset_handler -v interrupts="tick_interrupt uart_interrupt" -f stack.awk FILES.ci
# Prints bytes and the deepest way. Fails where it cannot be known: a call through a pointer, recursion, a
# frame of variable size, a function without a figure.
# Interrupts have priorities of their own: all may be under way at once, on top of the deepest point of the rest.

BEGIN {
    ENTRY = 112  # of an interrupt: 26 words with the floating-point registers, aligned
    LIBRARY = 96 # libgcc's and memory.c's functions, which gcc may call without saying so; none calls others
}

function quoted(key,    text) {
    text = $0
    if (!sub(".*" key ": \"", "", text)) return ""
    sub(/".*/, "", text)
    return text
}

/^node:/ {
    name = quoted("title")
    if (match($0, /[0-9]+ bytes \(/)) {
        own[name] = substr($0, RSTART) + 0
        if ($0 ~ /bytes \(dynamic\)/) varies[name] = 1
    }
}
/^edge:/ {
    from = quoted("sourcename")
    calls[from] = calls[from] quoted("targetname") "\n"
}

function fail(text) {
    print "stack.awk: " text >"/dev/stderr"
    failed = 1
    exit 1
}

# Deepest stack of name and what it calls; way[name]: the next one on the deepest way.
function depth(name,    list, n, i, d, most) {
    if (name in known) return known[name]
    if (name == "__indirect_call") fail("a call through a pointer, by " caller)
    if (name ~ /^__aeabi_/) return 0 # LIBRARY
    if (name in open) fail("recursion through " name)
    if (!(name in own)) fail("no figure for " name ", called by " caller)
    if (name in varies) fail("the frame of " name " is of variable size")
    open[name] = 1
    n = split(calls[name], list, "\n")
    for (i = 1; i < n; i++) {
        caller = name
        d = depth(list[i])
        if (d > most) { most = d; way[name] = list[i] }
    }
    delete open[name]
    return known[name] = own[name] + most
}

function show(name,    text) {
    for (text = name " " own[name]; name in way; name = way[name])
        text = text ", " way[name] " " own[way[name]]
    return text
}

END {
    if (failed) exit 1
    total = depth(root) + LIBRARY
    n = split(interrupts, list, " ")
    for (i = 1; i <= n; i++)
        total += ENTRY + depth(list[i]) + LIBRARY
    print total
    print show(root)
    for (i = 1; i <= n; i++) print show(list[i])
}
