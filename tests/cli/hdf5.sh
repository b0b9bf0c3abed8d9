#!/bin/sh
# hdf5.sh: experiments go into HDF5 and come back to the bit; tables of other programs' HDF5 files; damaged files.
. tests/cli/common

printf '# palpate.experiment: 1\n# specimen.height_mm: 24.0\n# specimen.kind: "K\303\266rper \\"A\\""\n# tester.list: [1, 2.5, null]\n# tester.whole: 7\n# tester.flag: true\n' >run.csv
echo 'time_s,depth_mm,force_N,temperature_C' >>run.csv
awk 'BEGIN { for (i = 0; i < 20000; i++) printf "%.17g,%.17g,%.17g,%d\n", i / 1000, i / 7e3, (i / 3e3) ^ 1.5, 20 + i % 3 }' >>run.csv
echo '# end.fault: "over_temperature"' >>run.csv
"$PALPATE" import run.csv --out run.h5 2>err; code=$?
if grep -q "built without HDF5" err; then
    [ $code -eq 1 ] && says "run.h5: this palpate was built without HDF5; install libhdf5-dev"
    echo "this palpate was built without HDF5: install libhdf5-dev and build it again"
    [ $failures -eq 0 ] && exit 77
fi
[ $code -eq 0 ] || fail "$(cat err)"

# ---- there and back ----
expect 0 import run.h5 --out back.csv
# The library's own CSV, to which any other is rewritten with the shortest digits: once more through HDF5, the same bytes.
expect 0 import back.csv --out again.h5
expect 0 import again.h5 --out runs
cmp back.csv runs/again.csv && cmp run.h5 again.h5 || fail "another file after a second time"
grep '^#' run.csv >wanted; grep '^#' back.csv | cmp - wanted || fail "the header is another"
# Every double is the same: awk compares numbers as strtod reads them.
grep -v '^#' run.csv | sed 1d >numbers; grep -v '^#' back.csv | sed 1d | paste -d, numbers - |
    awk -F, '{ for (j = 1; j <= 4; j++) if ($j - $(j + 4) != 0) exit 1; n++ } END { exit n != 20000 }' || fail "other numbers"
expect 1 import run.h5 --out back.csv; says "is a recording; name another output, or give --force"
expect 1 import run.csv --out run.csv; says "is already an experiment"
expect 1 import run.csv again.h5 --out two.h5; says "takes one experiment CSV of palpate"
[ -e two.h5 ] && fail "a file although it failed"

# ---- cut and damaged ----
for size in 100 2000 300000; do
    head -c $size run.h5 >cut.h5
    expect 1 import cut.h5 --specimen-height-mm 24 --out cut; says "cut.h5: the HDF5 file is truncated or damaged"
done
[ -e cut ] && fail "a folder for nothing"
# A byte in the middle of the numbers is a number; one in the names of what is in the file is an error in one line.
for at in 60 200 400 700; do
    cp run.h5 hurt.h5
    printf '\377\377\377\377' | dd of=hurt.h5 bs=1 seek=$at conv=notrunc 2>/dev/null
    "$PALPATE" import hurt.h5 --specimen-height-mm 24 --out hurt --force >out 2>err
    code=$?
    [ $code -eq 0 ] || { [ $code -eq 1 ] && says "hurt.h5: "; } || fail "byte $at: exit code $code"
done

# ---- h5py reads it, and what others write with it is imported ----
python_with h5py h5py numpy
"$python" -B "$ROOT/tests/cli/hdf5.py" read run.h5 run.csv || fail "h5py does not read what is in the CSV"
"$python" -B "$ROOT/tests/cli/hdf5.py" write || fail "hdf5.py"
for file in group record matrix matlab apart; do
    expect 0 import $file.h5 --specimen-height-mm 24 --contact recorded --out others
    "$python" -B "$ROOT/tests/cli/hdf5.py" same others/$file.csv || fail "$file.h5: other numbers"
done
grep -qx '# tester.operator: "N. N."' others/group.csv && grep -qx '# tester.gain: 2.5' others/group.csv || fail "settings of the group"
grep -qx '# import.units: "ms, um, mN"' others/group.csv || fail "units"
expect 0 import apart.h5 --specimen-height-mm 24 --contact recorded --map time=time/data,depth=stage/data,force=cell/data --out apart.csv
cmp apart.csv others/apart.csv || fail "other columns by their names"
expect 0 import two.h5 --specimen-height-mm 24 --contact recorded --out others
"$python" -B "$ROOT/tests/cli/hdf5.py" same others/two_02.csv || fail "the second group"
expect 2 import two.h5 --specimen-height-mm 24 --out one.csv; says "one file for 2 recordings; name a folder"
expect 1 import text.h5 --out others; says "has no two columns of as many numbers"
expect 0 import own.h5 --out own.csv
"$python" -B "$ROOT/tests/cli/hdf5.py" same own.csv || fail "an experiment that h5py wrote"
for file in nan missing version; do
    expect 1 import $file.h5 --out $file.csv
    [ -e $file.csv ] && fail "$file.csv although it failed"
done
says "palpate.experiment must be 1"
done_testing
