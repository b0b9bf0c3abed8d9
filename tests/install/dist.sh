#!/bin/sh
# dist.sh: what `make dist` packs builds outside of git, passes tests and installs, and the version stands in one place:
# the copy has another one, which library, command, pkg-config file and documents must then have.
set -eu
cd "$(dirname "$0")/../.."
MAKE=${MAKE:-make} CC=${CC:-gcc}
git rev-parse --git-dir >/dev/null 2>&1 || { echo "no git repository, so nothing to pack"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset BUILD
header=include/palpate/version.h
version=$(sed -n 's/^.define PALP_VERSION "\(.*\)"/\1/p' $header)

fail() { echo "$*"; exit 1; }

grep -q "^## $version " CHANGELOG.md || fail "CHANGELOG.md has no heading for $version"
sed q debian/changelog | grep -q "^palpate ($version[-)]" || fail "debian/changelog does not begin with $version"
more=$(git grep -lF "$version" -- Makefile lib tools firmware include examples bench '*.scd' ':!'$header) || true
[ -z "$more" ] || fail "the version stands in $more too"

$MAKE --no-print-directory dist DISTDIR="$work"
tar -xzf "$work/palpate-$version.tar.gz" -C "$work"
cd "$work/palpate-$version"
GIT_CEILING_DIRECTORIES=$work
export GIT_CEILING_DIRECTORIES
sed -i "s/^\(.define PALP_VERSION \).*/\1\"9.8.7\"/" $header
sed -i "s/^## $version .*/## 9.8.7 - 2000-01-01/" CHANGELOG.md

# A released interface stays as it is, unless the soname changes.
$MAKE -s symbols
grep -q '^PALPATE_9 {' lib/palpate.map && grep -qx 'soname libpalpate.so.9' lib/palpate.abi || fail "make symbols: another soname"
sed -i 's/^\(typedef struct palp_contact_settings {\)/\1 int more;/' include/palpate/tool.h
if $MAKE -s symbols 2>said; then fail "make symbols takes another structure under a released soname"; fi
grep -q '^typedef struct palp_contact_settings ' said || fail "make symbols said: $(cat said)"
sed -i 's/^\(typedef struct palp_contact_settings {\) int more;/\1/' include/palpate/tool.h

# Optimization takes most of the time of a build, and nothing here looks at speed.
$MAKE -s --no-print-directory -j"$(nproc)" CC="$CC" CFLAGS=-O0 all build/tests/lib/material/test_law build/tests/firmware/test_pid
build/tests/lib/material/test_law
build/tests/firmware/test_pid
for t in documents symbols; do
    sh tests/install/$t.sh || fail "tests/install/$t.sh failed in the unpacked tree"
done
$MAKE -s --no-print-directory CC="$CC" CFLAGS=-O0 install DESTDIR="$work/stage" PREFIX=/usr >/dev/null
lib=$work/stage/usr/lib
[ "$("$work/stage/usr/bin/palpate" --version)" = "palpate 9.8.7" ] || fail "palpate --version is not that of version.h"
grep -qx 'Version: 9.8.7' "$lib/pkgconfig/palpate.pc" || fail "palpate.pc has another version"
[ "$(readlink "$lib/libpalpate.so.9")" = libpalpate.so.9.8.7 ] || fail "the shared library has another version: $(ls "$lib")"
