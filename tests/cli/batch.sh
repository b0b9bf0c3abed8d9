#!/bin/sh
# batch.sh: many jobs: order, table, hostile names, failures, a killed batch that goes on, tasks, two at once, a full disk. check: asan
. tests/cli/common

M=$DATA/network_27.json L=$DATA/lumped_n1.json

# job NAME DEPTH [DT]: an entry of a manifest: a press, which takes the longer the smaller its steps in ms are
job() {
    printf '{"name": "%s", "arguments": ["simulate", "%s", "--protocol", "static", "--depth-mm", "%s", "--dt-ms", "%s", "--json", "--out", "made/%s.csv"]}' \
        "$1" "$M" "$2" "${3-20}" "$1"
}
manifest() { echo '{"palpate": {"batch": 1}, "about": "a test", "jobs": ['; cat; echo ']}'; } # entries, one a line

# listed FOLDER: the journal's names and hashes; lines FOLDER: how many
listed() { sed '/^#/d' "$1/journal" | cut -d' ' -f1,2 | LC_ALL=C sort -u; }
lines() { grep -vc '^#' "$1/journal"; }

# same A B: two folders of results have the same files, but for times; nothing temporary is left in either
same() {
    for folder in "$1" "$2"; do
        rm -rf "$folder.bare"
        cp -r "$folder" "$folder.bare"
        rm -f "$folder.bare"/lock* "$folder.bare/index.html"
        listed "$folder" >"$folder.bare/journal"
        cut -d, -f1,2,4- "$folder/table.csv" >"$folder.bare/table.csv"
        ls -a "$folder" | grep -q 'tmp$' && fail "a temporary file is left in $folder: $(ls "$folder")"
    done
    diff -r "$1.bare" "$2.bare" >difference || fail "$1 and $2 differ: $(head -n 5 difference)"
}

# ---- order, content, statuses ----
mkdir made
for i in 1 2 3 4 5 6 7 8 9; do echo "$(job j$i $((10 - i))),"; done >entries
{ cat entries; job last 2; } | manifest >jobs.json
expect 0 batch jobs.json --out plain
[ "$(cat out)" = "10 jobs: 10 succeeded, 0 failed, 0 not done" ] || fail "the summary: $(cat out)"
[ -s err ] && fail "a batch without fault says: $(cat err)"
[ "$(cut -d, -f1,2 plain/table.csv | tr '\n' ' ')" = "name,status j1,0 j2,0 j3,0 j4,0 j5,0 j6,0 j7,0 j8,0 j9,0 last,0 " ] ||
    fail "the table's rows: $(cut -d, -f1,2 plain/table.csv)"
head -n 1 plain/table.csv | grep -q '^name,status,seconds,model,kind,protocol,peak_force_N' || fail "columns: $(head -n 1 plain/table.csv)"
"$PALPATE" simulate "$M" --protocol static --depth-mm 7 --dt-ms 20 --json --out alone.csv >alone.json
cmp -s alone.json plain/j3.out && [ ! -s plain/j3.err ] || fail "a job's output is not that of the command alone"
cmp -s alone.csv made/j3.csv || fail "a job's file is not that of the command alone"
peak=$(value alone.json peak_force_N)
grep -q "^j3,.*,$peak," plain/table.csv || fail "the table lacks the peak force $peak of j3"
in_page plain/index.html
[ "$(grep -c '"status": 0' shown)" -eq 10 ] || fail "the page has not ten jobs"

# What has ended is not done again; a job with another argument is, and one whose output is gone.
cp plain/journal before
expect 0 batch jobs.json --out plain
cmp -s plain/journal before || fail "a batch that has ended is done again"
cp -r plain kept
{ cat entries; job last 3; } | manifest >changed.json
expect 0 batch changed.json --out plain
[ "$(lines plain)" -eq 11 ] && [ "$(tail -n 1 plain/journal | cut -d' ' -f1)" = last ] || fail "not only the changed job is done: $(cat plain/journal)"
expect 0 batch jobs.json --out plain
[ "$(lines plain)" -eq 12 ] && cmp -s plain/last.out kept/last.out || fail "a job that is as before is not done again"
rm plain/j5.out
expect 0 batch jobs.json --out plain
[ "$(lines plain)" -eq 13 ] && cmp -s plain/j5.out kept/j5.out || fail "an output that was removed is not made again"
rm -rf plain && mv kept plain

# A failed job is listed and ends nothing; --retry-failed does it anew; what does not converge gives 3.
{ cat entries; echo '{"name": "bad", "arguments": ["simulate", "late.json", "--protocol", "static", "--depth-mm", "2", "--json"]}'; } | manifest >failing.json
expect 1 batch failing.json --out failing
says "palpate batch: bad: exit status 1: palpate simulate: late.json: cannot open"
grep -q '^bad,1,[0-9.]*,,' failing/table.csv || fail "the table's row: $(grep bad failing/table.csv)"
cp $L late.json
expect 1 batch failing.json --out failing
[ "$(lines failing)" -eq 10 ] || fail "a failed job is done again without --retry-failed"
expect 0 batch failing.json --out failing --retry-failed
[ "$(lines failing)" -eq 11 ] && grep -q '^bad,0,' failing/table.csv || fail "not only the failed job is done: $(cat failing/journal)"
sed 's/"strain_max"[^,}]*,//; s/"coefficients_N": *\[[^]]*\]/"coefficients_N": [0.5]/' $L >soft.json
echo '{"name": "force", "arguments": ["simulate", "soft.json", "--protocol", "creep", "--force-N", "50", "--hold-s", "1", "--json"]}' | manifest >creep.json
"$PALPATE" simulate soft.json --protocol creep --force-N 50 --hold-s 1 >/dev/null 2>&1
code=$?
expect $code batch creep.json --out creep
[ $code -eq 3 ] || fail "the press that does not converge ends with $code"
echo '{"name": "usage", "arguments": ["simulate", "--no-such"]}' | manifest >usage.json
expect 1 batch usage.json --out usage
says "usage: exit status 2"

# ---- templates and hostile names ----
mkdir data
for name in "a b" "c'd" 'e"f' "-g" '$(touch ran)' "%41#" ".hidden" "$(printf 'new\nline')" "$(printf 'byte\377')"; do cp alone.csv "data/$name.csv"; done
cat >each.json <<J
{"palpate": {"batch": 1}, "command": ["report", "{input}", "--title", "{name} {index} {other}", "--out", "{name}.html"], "inputs": "data/*.csv"}
J
expect 0 batch each.json --out each
[ "$(find . -maxdepth 1 -name '*.html' | grep -c .)" -ge 8 ] || fail "pages of hostile names: $(ls)"
[ -e ran ] && fail "a name was run"
[ -e ./-g.html ] && grep -q '"title":"-g [0-9] {other}"' ./-g.html || fail "placeholders: $(grep -o '"title":"[^"]*"' ./-g.html)"
expect 0 batch each.json --out each
[ "$(lines each)" -eq 8 ] || fail "a hostile name is not found in the journal: $(cat each/journal)"
cut -d, -f1 each/table.csv | grep -q '^"e""f"$' || fail "a quote in the table: $(cat each/table.csv)"
rm -f ./*.html
cd data || exit 1
expect 0 batch --template 'report {input} --out ../{name}.html' --out ../words -- -g.csv .hidden.csv
cd ..
[ -e -g.html ] && [ -e .hidden.html ] || fail "a template's pages: $(ls -a)"
# A word that is a pattern becomes the files that match it, of an input that is taken to the letter. A new file is another job.
mkdir "p[1]" p1 p2
for file in "p[1]/r2" "p[1]/r1" p1/r3; do cp alone.csv "$file.csv"; done
files_of() { sed -n 's/^ *"command": "palpate characterize \(.*\) --arms.*/\1/p' "folders/$1"; }
for times in 3 4; do
    expect 1 batch --template 'characterize {input}/r?.csv --arms 0 --degree 2 --json' --out folders "p[1]" p1 p2
    says "p2: exit status 1: palpate characterize: p2/r?.csv: cannot open"
    [ "$(lines folders)" -eq $times ] || fail "jobs of folders: $(cat folders/journal)"
    [ "$(files_of "p[1].out")" = "p[1]/r1.csv p[1]/r2.csv" ] || fail "files of a pattern: $(files_of "p[1].out")"
    cp alone.csv p1/r0.csv
done
[ "$(files_of p1.out)" = "p1/r0.csv p1/r3.csv" ] || fail "files of a pattern: $(files_of p1.out)"
cat >list.json <<J
{"palpate": {"batch": 1}, "command": ["simulate", "$L", "--protocol", "static", "--depth-mm", "{input}"],
 "name": "{index}_{name}",
 "inputs": ["2",
            "3", "2"]}
J
expect 0 batch list.json --out numbered
[ -s numbered/0_2.out ] && [ -s numbered/2_2.out ] || fail "names of a pattern: $(ls numbered)"
mkdir elsewhere
cp list.json elsewhere
(cd / && "$PALPATE" batch "$SCRATCH/elsewhere/list.json" --out "$SCRATCH/elsewhere/numbered" >/dev/null) || fail "a manifest of another folder"

# Each fault of a manifest: one line with its place, and nothing is run.
refused() { # PLACE TEXT: of refused.json
    expect 1 batch refused.json --out never
    says "palpate batch: refused.json$1: "
    says "$2"
}
manifest >refused.json <<J
{"name": "b", "arguments": ["--version"]},
{"name": "../a", "arguments": ["--version"]}
J
refused :3 'the name "../a" has a slash'
for name in . .. ""; do echo "{\"name\": \"$name\", \"arguments\": [\"--version\"]}" | manifest >refused.json; refused :2 "the name \"$name\" is"; done
{ echo "{\"name\": \"$(printf %241s | tr ' ' a)\", \"arguments\": [\"--version\"]}"; } | manifest >refused.json; refused :2 "is longer than 240 bytes"
manifest >refused.json <<J
{"name": "a, ]\" b", "arguments": ["--version", "{ ["]},
{"name": "b", "arguments": ["--version"]},
{"name": "a, ]\" b", "arguments": ["--version"]}
J
refused :4 'the name "a, ]" b" is that of an earlier job'
sed '/"name"/d' list.json >refused.json; refused :3 'the name "2" is that of an earlier job'
sed 's/"3"/3/' list.json >refused.json; refused :3 "inputs must be a pattern or a list of texts"
echo '{"name": "a", "arguments": ["--version"], "argument": 1}' | manifest >refused.json; refused :2 "argument is no key of a job"
echo '{"name": "a", "arguments": []}' | manifest >refused.json; refused :2 "must be a list of texts"
echo '{"arguments": ["--version"]}' | manifest >refused.json; refused :2 "has no name"
echo '1' | manifest >refused.json; refused :2 "a job is an object"
manifest </dev/null >refused.json; refused :1 "jobs must be a list with a job in it"
echo '{"palpate": {"batch": 1}, "job": []}' >refused.json; refused :1 "job is no key of a manifest"
echo '{"palpate": {"batch": 1}}' >refused.json; refused :1 "it needs jobs, or command and inputs"
echo '{"palpate": {"model": 1}, "jobs": []}' >refused.json; refused :1 "is no manifest"
printf '{"palpate": {"batch": 1},\n "jobs": [}' >refused.json; refused :2 "malformed JSON"
sed 's/"data/"nowhere/' each.json >refused.json; refused :1 "no file matches inputs"
expect 1 batch nowhere.json --out never; says "nowhere.json: cannot open"
[ -e never ] && fail "a manifest with a fault leaves a folder"
expect 2 batch jobs.json; says "name a folder for the results by --out"
expect 2 batch --out never; says "name one manifest"
expect 2 batch --template '{input}' --out never; says "name the inputs"
expect 2 batch --template ' ' a --out never; says "--template has no command"
for task in 3/3 1 -1/3 1/0 a/b 1/3x; do expect 2 batch jobs.json --out never --task $task; says "--task must be I/N"; done
expect 2 batch jobs.json --out never --mpi; says "--mpi needs mpirun or srun"
for way in --collect "--slurm 2" --mpi; do expect 2 batch jobs.json --out never --task 0/3 $way; says "exclude each other"; done

# ---- a batch that is cut off goes on ----
for i in 1 2 3 4 5 6 7 8; do echo "$(job k$i $i 2),"; done >entries
{ cat entries; job k9 9 2 | sed "s,$M,swapped.json,"; } | manifest >slow.json
cp "$M" swapped.json
expect 0 batch slow.json --out whole
for number in KILL TERM; do
    "$PALPATE" batch slow.json --out cut$number --jobs 2 >cut.out 2>cut.err &
    batch=$!
    await sh -c "[ \"\$(grep -vc '^#' cut$number/journal)\" -ge 3 ]"
    kill -$number $batch
    wait $batch 2>/dev/null && fail "a batch that signal $number ends ends well"
    cp cut$number/journal before
    [ "$(lines cut$number)" -lt 9 ] || fail "the batch had ended before signal $number"
    expect 0 batch slow.json --out cut$number
    head -c "$(wc -c <before)" cut$number/journal | cmp -s - before || fail "the journal before signal $number is another one"
    [ "$(lines cut$number)" -eq 9 ] || fail "a job is done twice after signal $number: $(cat cut$number/journal)"
    same whole cut$number
done
grep -q "palpate batch: stopped with [3-8] of 9 jobs done; the same command goes on" cut.err || fail "a batch that is stopped says: $(cat cut.err)"

# A line that was not written whole, and one that is none.
head -c "$(($(wc -c <whole/journal) - 5))" whole/journal >cutKILL/journal
expect 0 batch slow.json --out cutKILL
[ "$(lines cutKILL)" -eq 9 ] && same whole cutKILL
sed '3s/ 0 / zero /' whole/journal >cutKILL/journal
expect 1 batch slow.json --out cutKILL; says "cutKILL/journal:3: is no line of a journal"

# A job that is killed is listed; the next run does it again, and no other. Of its many nodes it takes long.
sed 's/\[3, 3, 3\]/[21, 21, 21]/' "$M" >swapped.json
"$PALPATE" batch slow.json --out child --jobs 2 >child.out 2>child.err &
batch=$!
await sh -c "[ \"\$(grep -vc '^#' child/journal)\" -eq 8 ]"
for child in $(grep -l "^PPid:[[:blank:]]*$batch$" /proc/[0-9]*/status 2>/dev/null | cut -d / -f 3); do kill -9 "$child"; done
wait $batch
[ $? -eq 1 ] && grep -q "palpate batch: k9: ended by signal 9" child.err || fail "a job that is killed: $(cat child.err)"
grep -q '^k9,137,' child/table.csv || fail "the table of a killed job: $(tail -n 1 child/table.csv)"
cp "$M" swapped.json
expect 0 batch slow.json --out child
[ "$(lines child)" -eq 10 ] && [ "$(grep -c '^k9 ' child/journal)" -eq 2 ] || fail "not only the killed job is done again: $(cat child/journal)"
sed -i '/^k9 .* 137 /d' child/journal
same whole child

# ---- tasks ----
for task in 0 1 2; do expect 0 batch slow.json --out tasks --task $task/3; done
[ "$(cat out)" = "3 jobs: 3 succeeded, 0 failed, 0 not done" ] && [ ! -e tasks/table.csv ] || fail "a task: $(cat out)"
expect 0 batch slow.json --out tasks --collect
[ -e tasks/journal.0 ] && fail "the journals of tasks are left"
same whole tasks
for rank in 0 1; do
    (export OMPI_COMM_WORLD_RANK=$rank OMPI_COMM_WORLD_SIZE=2 && "$PALPATE" batch slow.json --out ranks --mpi >/dev/null) || fail "rank $rank"
done
expect 0 batch slow.json --out ranks
same whole ranks
expect 0 batch slow.json --out part --task 1/3
expect 1 batch slow.json --out part --collect
[ "$(cat out)" = "9 jobs: 3 succeeded, 0 failed, 6 not done" ] && grep -q '^k1,,,' part/table.csv || fail "a part: $(cat out)"
if command -v mpirun >/dev/null; then
    mpirun --allow-run-as-root --oversubscribe -n 4 "$PALPATE" batch failing.json --out mpi --mpi >mpi.out 2>mpi.err || fail "mpirun: $(cat mpi.err)"
    [ "$(ls mpi/journal.? | wc -l)" -eq 4 ] || fail "mpirun: $(ls mpi)"
    expect 0 batch failing.json --out mpi --collect
fi

# The script for Slurm, with programs in place of sbatch that run what it submits.
expect 0 batch slow.json --out "s'lurm" --slurm 3
[ "$(cat out)" = "Submit it by: sh s'lurm/slurm.sh" ] && [ ! -e "s'lurm/journal" ] || fail "--slurm: $(cat out)"
mkdir bin
cat >bin/sbatch <<'END'
#!/bin/sh
echo "$*" >>"$SUBMITTED"
cat >job.sh
case $* in
*--array*) for i in 0 1 2; do SLURM_ARRAY_TASK_ID=$i sh job.sh >&2; done ;;
*) sh job.sh >&2 ;;
esac
echo "7;cluster"
END
chmod +x bin/sbatch
SUBMITTED=$PWD/submitted PATH=$PWD/bin:$PATH sh "s'lurm/slurm.sh" --time=5 >out 2>err || fail "the script: $(cat err)"
[ "$(cat submitted)" = "--parsable --job-name=palpate --array=0-2 --time=5
--parsable --job-name=palpate-collect --dependency=afterany:7 --time=5" ] || fail "submitted: $(cat submitted)"
rm "s'lurm/slurm.sh"
same whole "s'lurm"

# ---- two on one folder, and folders that cannot be written ----
sed 's/\[3, 3, 3\]/[21, 21, 21]/' "$M" >large.json
"$PALPATE" batch --template "simulate {input} --protocol static --depth-mm 9" large.json --out both >/dev/null 2>both.err &
batch=$!
await test -e both/large.out.tmp
for way in "" --collect "--task 0/2"; do
    expect 1 batch jobs.json --out both $way
    says "palpate batch: both: another batch works here already"
done
kill $batch
wait $batch
"$PALPATE" batch --template "simulate {input} --protocol static --depth-mm 9" large.json --out both --task 0/2 >/dev/null 2>both.err &
batch=$!
await test -e both/large.out.tmp
expect 1 batch jobs.json --out both --task 0/2; says "the same task works here already"
expect 0 batch jobs.json --out both --task 1/2
kill $batch
wait $batch
: >file
expect 1 batch jobs.json --out file; says "palpate batch: file: is not a folder"
expect 1 batch jobs.json --out nowhere/folder; says "palpate batch: nowhere/folder: is not a folder and cannot be created"
mkdir -p taken/lock
expect 1 batch jobs.json --out taken; says "palpate batch: taken/lock: cannot write: Is a directory"
if [ "$(id -u)" -eq 0 ] && mkdir small && mount -t tmpfs -o size=16k tmpfs small 2>/dev/null; then
    expect 1 batch slow.json --out small; says "No space left on device"
    left=$(ls small | grep -c 'tmp$')
    mount -o remount,size=1m small
    expect 0 batch slow.json --out small --retry-failed
    rm -rf large && cp -r small large
    umount small
    [ "$left" -eq 0 ] || fail "on a full disk $left temporary files are left"
    same whole large
fi
done_testing
