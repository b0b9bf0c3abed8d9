#!/bin/sh
# documents.sh: what the documentation names exists: the targets of its links, the paths of sources, the public headers
# in palpate(3) and the commands in palpate(1). CHANGELOG.md is left out: it also names what is gone.
set -eu
cd "$(dirname "$0")/../.."
BUILD=${BUILD:-build}
missing=$(
    for page in README.md CONTRIBUTING.md doc/*.md data/*/README.md tests/*/README.md python/README.md doc/*.scd; do
        folder=$(dirname "$page")
        # links, without those to other sites and to a place in the same page
        grep -o '](\([^)#:]*\)[)#]' "$page" | sed 's/](//; s/[)#]$//' | while read -r target; do
            [ -z "$target" ] || [ -e "$folder/$target" ] || echo "$page: there is no $target"
        done
        # paths that begin with a folder of the tree; those with a * or <name> in them stand for many
        grep -oE '(^|[^A-Za-z0-9_./-])(lib|tools|tests|firmware|include|bench|data|doc|python)/[A-Za-z0-9_./*<-]+\.(c|h|sh|py|md|json|mk|awk|dot)\b' "$page" |
            sed 's/^[^a-z]//' | LC_ALL=C sort -u | while read -r path; do
            case $path in *'*'* | *'<'* | *NAME*) continue ;; esac
            [ -e "$path" ] || echo "$page: there is no $path"
        done
    done
    for header in include/palpate/*.h; do
        name=${header##*/}
        case $name in palpate.h | export.h) continue ;; esac
        grep -q "\*$name\*" doc/palpate.3.scd || echo "doc/palpate.3.scd: does not name $name"
    done
    "$BUILD/palpate" --help | sed -n 's/^  \([a-z]*\)  .*/\1/p' | while read -r command; do
        grep -q "^\*$command\*" doc/palpate.1.scd || echo "doc/palpate.1.scd: does not name $command"
    done
)
[ -z "$missing" ] || { echo "$missing"; exit 1; }
