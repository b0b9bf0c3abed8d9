#!/bin/sh
# packaging.sh: the files for vcpkg and conda: they parse and have the version of version.h, and conda's build script installs
# libraries that a program links.
set -eu
cd "$(dirname "$0")/../.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }
version=$(sed -n 's/^.define PALP_VERSION "\(.*\)"/\1/p' include/palpate/version.h)
port=packaging/vcpkg/palpate

command -v python3 >/dev/null || { echo "there is no python3"; exit 77; }
[ "$(python3 -c 'import json, sys; port = json.load(open(sys.argv[1])); print(port["name"], port["version"])' $port/vcpkg.json)" = "palpate $version" ] ||
    fail "vcpkg.json does not parse, or its version is not $version"
grep -qx "  version: \"$version\"" packaging/conda/meta.yaml || fail "meta.yaml: its version is not $version"
# What conda-build sees: its expressions are gone, and comments are selectors.
sed 's/{{ *compiler("c") *}}/compiler/; s/{{.*}}/pin/' packaging/conda/meta.yaml >"$work/meta.yaml"
if python3 -c 'import yaml' 2>/dev/null; then
    python3 -c 'import sys, yaml; m = yaml.safe_load(open(sys.argv[1])); assert set(m) == {"package", "source", "build", "requirements", "test", "about"}' \
        "$work/meta.yaml" || fail "meta.yaml does not parse"
fi
if command -v cmake >/dev/null; then # vcpkg's functions as empty ones: the rest of the file runs
    {
        for f in vcpkg_find_acquire_program vcpkg_cmake_get_vars vcpkg_execute_required_process vcpkg_cmake_config_fixup \
            vcpkg_fixup_pkgconfig vcpkg_install_copyright; do echo "function($f)"; echo "endfunction()"; done
        echo "set(cmake_vars_file \"$work/empty.cmake\")"
        cat $port/portfile.cmake
    } | sed "s|\${CMAKE_CURRENT_LIST_DIR}|$PWD/$port|" >"$work/port.cmake"
    : >"$work/empty.cmake"
    cmake -DCURRENT_PACKAGES_DIR="$work/none" -P "$work/port.cmake" >"$work/said" 2>&1 || fail "portfile.cmake: $(cat "$work/said")"
fi
case $(cd $port/../../.. && pwd) in "$PWD") ;; *) fail "the port does not lie where portfile.cmake takes it to be" ;; esac

# The build script, on a copy without what was built here.
mkdir "$work/tree"
git ls-files -z 2>/dev/null | xargs -0 cp --parents -t "$work/tree" || fail "the tree cannot be copied"
(cd "$work/tree" && PREFIX="$work/prefix" CFLAGS=-O1 CPU_COUNT=$(nproc) sh packaging/conda/build.sh) >"$work/said" 2>&1 ||
    fail "build.sh: $(tail -n 20 "$work/said")"
# The commands of meta.yaml's test.
sed -n '/^test:/,/^about:/s/^ *- \(test .*\)/\1/p' packaging/conda/meta.yaml >"$work/tests"
[ "$(wc -l <"$work/tests")" -ge 4 ] || fail "meta.yaml has no tests"
PREFIX="$work/prefix" sh -e "$work/tests" || fail "what meta.yaml looks for is not installed"
[ ! -e "$work/prefix/bin" ] || fail "more than the libraries was installed"
export PKG_CONFIG_PATH="$work/prefix/lib/pkgconfig"
# shellcheck disable=SC2046
gcc -o "$work/minimal" examples/minimal.c $(pkg-config --cflags --libs palpate) -lm
(cd "$work" && LD_LIBRARY_PATH="$work/prefix/lib" ./minimal "$OLDPWD/data/sedef2008/network_27.json" >/dev/null) || fail "a program with the installed library fails"
