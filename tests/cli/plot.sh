#!/bin/sh
# plot.sh: figures by gnuplot, and what is said where there is none.
. tests/cli/common

L=$DATA/lumped_n1.json
mkdir empty
PATH_WAS=$PATH
PATH=$SCRATCH/empty "$PALPATE" calibrate $L --nodes 3 --stage static --depth-mm 5 --plot none >out 2>err
code=$?
PATH=$PATH_WAS
[ $code -eq 0 ] || fail "without gnuplot: exit code $code"
says "warning: gnuplot is not installed"
touch file
expect 1 calibrate $L --nodes 3 --stage static --depth-mm 5 --plot file
says "file: is no folder"

command -v gnuplot >/dev/null || { [ "$failures" -eq 0 ] && { echo "gnuplot is not installed"; exit 77; }; done_testing; }
expect 0 calibrate $L --nodes 3 --stage all --depth-mm 2,4 --hold-s 20 --plot plots
for name in static_convergence static_fit stiffness relaxation_convergence relaxation_linear relaxation_log; do
    head -n 5 plots/$name.svg 2>/dev/null | grep -q '<svg' || { fail "no figure $name.svg"; continue; }
    grep -q 'width="900" height="560"\|viewBox="0 0 900 560"' plots/$name.svg || fail "$name.svg: not 900 x 560"
    tail -n 3 plots/$name.svg | grep -q '</svg>' || fail "$name.svg is cut short"
done
grep -q 'force (N)' plots/static_fit.svg || fail "static_fit.svg lacks the unit of the force"
ls plots | grep -q tmp && fail "a temporary file was left behind"
done_testing
