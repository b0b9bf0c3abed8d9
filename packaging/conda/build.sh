#!/bin/sh
# build.sh: conda's build: the libraries into PREFIX, against what conda installed there.
set -eu
export PKG_CONFIG_PATH="$PREFIX/lib/pkgconfig${PKG_CONFIG_PATH:+:$PKG_CONFIG_PATH}"
# conda's SuiteSparse, BLAS and LAPACK have headers and libraries in the prefix, with or without .pc files.
if [ -e "$PREFIX/include/suitesparse/cholmod.h" ]; then export SUITESPARSE_CFLAGS="-isystem $PREFIX/include/suitesparse"; fi
if [ -e "$PREFIX/lib/liblapack.so" ]; then export BLAS_LIBS="-L$PREFIX/lib -llapack -lblas"; fi
make -j"${CPU_COUNT:-1}" install-lib PREFIX="$PREFIX" CC="${CC:-gcc}" \
    ${CFLAGS:+"CFLAGS=-O3 $CFLAGS"} ${LDFLAGS:+"LDFLAGS=$LDFLAGS"} ${CPPFLAGS:+"CPPFLAGS=$CPPFLAGS"}
