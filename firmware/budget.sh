#!/bin/sh
# budget.sh: says what an image takes of flash, RAM and stack. Fails where the worst stack reaches into its
# guard; that flash and RAM suffice, the linker has seen to (stm32f405.ld).
#   firmware/budget.sh TOOL_PREFIX IMAGE.elf FILES.ci...     V=1: also the deepest way
set -u
prefix=$1 image=$2
shift 2
guard=32
symbol() { "${prefix}nm" "$image" | awk -v name="$1" '$3 == name { print "0x" $1 }'; }
bytes() { echo $(($(symbol "$2") - $(symbol "$1"))); }

answer=$(awk -v root=reset_handler -v interrupts="tick_interrupt uart_interrupt supply_interrupt" \
    -f "$(dirname "$0")/stack.awk" "$@") || exit 1
worst=$(echo "$answer" | head -n 1)
stack=$(bytes stack_bottom stack_top)
flash=$("${prefix}size" "$image" | awk 'NR == 2 { print $1 + $2 }')
ram=$(($(symbol reset_note) + 8 - $(symbol stack_bottom)))
echo "$(basename "$image"): flash $flash of 65536 bytes, RAM $ram of 32768, of it stack $stack, worst $worst"
if [ "${V-}" = 1 ]; then echo "$answer" | sed '1d; s/^/    /'; fi
if [ "$worst" -gt $((stack - guard)) ]; then
    echo "budget.sh: the stack of $image does not suffice" >&2
    exit 1
fi
