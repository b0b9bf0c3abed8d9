#!/bin/sh
# import_odd.sh: tables with results above them, segments, cantilevers, gaps, sheets, stretches in another clock. check: once
. tests/cli/common

key() { sed -n "s/^# $2: //p" "$1"; }
rows() { grep -c '^[0-9]' "$1"; }
# The press of all files here: 1 s at rest, 3 mm in 3 s, 3 s dwell; F = 2 d, to half in the dwell.
press='function press(k) { t = k / 10; d = t < 1 ? 0 : t < 4 ? t - 1 : 3; f = 2 * d; if (t > 4) f = 3 + 3 * exp(4 - t) } BEGIN { '
# same FILE ROWS: what it became.
same() {
    grep '^[0-9]' "$1" | awk -F, -v n="$2" 'NR == 1 { t0 = $1 } { t = $1 - t0; d = t < 1 ? 0 : t < 4 ? t - 1 : 3; f = t <= 4 ? 2 * d : 3 + 3 * exp(4 - t)
        if (($2 - d) ^ 2 > 1e-8 || ($3 - f) ^ 2 > 1e-8) { print $0 ", not " d "," f; bad = 1 } } END { if (NR != n) { print NR " rows"; bad = 1 } exit bad }' >why ||
        fail "$1: $(head -n 2 why)"
}

# ---- results above the data, as BlueHill Universal writes them ----
awk "$press"'print "Results Table 1\n,Maximum Load,Compressive displacement at maximum,Length,Diameter\n,(N),(mm),(mm),(mm)\n1,\"6.00\",\"3.00\",\"20.0\",\"10.0\"\nMean,6.00,3.00,20.0,10.0\n\nRaw Data\nTime,Displacement,Force,Displacement (Strain 1)\n(s),(mm),(N),(mm)"
    for (k = 0; k <= 70; k++) { press(k); printf "%.1f,\"%.4f\",%.6f,%.4f\n", t, d, f, d } }' >universal.csv
expect 0 import universal.csv --out made
same made/universal.csv 71
[ "$(key made/universal.csv specimen.height_mm)" = 20.0 ] && [ "$(key made/universal.csv specimen.radius_mm)" = 5.0 ] || fail "universal: specimen"

# ---- segments: of TRIOS (each with its header, the step's clock starts anew), without a header, of three specimens ----
awk "$press"'print "Sample\tgel\nGap\t20.0 mm\nDiameter\t8 mm\n"
    for (k = 0; k <= 70; k++) { press(k)
        if (k == 0 || k == 10 || k == 41) { print "[step]\nStep " ++n "\nTime\tStep time\tDisplacement\tAxial force\ns\ts\tum\tmN"; start = t }
        printf "%.1f\t%.1f\t%.2f\t%.4f\n", t, t - start, 1000 * d, 1000 * f } }' >trios.txt
expect 0 import trios.txt --out made
same made/trios.csv 71
[ "$(key made/trios.csv specimen.height_mm)" = 20.0 ] || fail "trios: height"
awk "$press"'print "Time (s);Weg (mm);Kraft (N)"; for (k = 0; k <= 70; k++) { press(k); if (k == 41) start = t - 0.1; printf "%.1f;%.4f;%.6f\n", t - start, d, f } }' >again.csv
expect 0 import again.csv --specimen-height-mm 20 --out made
same made/again.csv 71
grep -q "the clock restarts 1 time within the run" err || fail "again: nothing about the clock"
awk "$press"'for (s = 1; s <= 3; s++) { print "Specimen " s "\nTime (s)\tExtension (mm)\tLoad (N)"; for (k = 0; k <= 70; k++) { press(k); printf "%.1f\t%.4f\t%.6f\n", t, d, f }; print "" } }' >three.txt
expect 0 import three.txt --specimen-height-mm 20 --out three
[ "$(ls three | tr '\n' ' ')" = "three_01.csv three_02.csv three_03.csv " ] || fail "three: $(ls three)"
for i in 1 2 3; do same three/three_0$i.csv 71; done

# ---- a cantilever: the height of its base and its deflection in V or nm, or the force; deeper = base down less bending ----
# k = 0.04 N/m, 60 nm/V; the tip goes 1 um into the sample, 10 nN; the base goes as much further as it bends.
cantilever() { # columns units, printf of z (m), deflection (m), t
    echo "# approach"; echo "# springConstant: 0.04"; echo "# sensitivity: 6e-8"; echo "#"; echo "# columns: $1"; echo "# units: $2"
    awk -v third="$3" 'BEGIN { for (k = 0; k <= 300; k++) { t = k / 1000; tip = (k - 200) * 1e-8; f = tip > 0 ? 1e-2 * tip : 0; bend = f / 0.04
        if (third == "V") out = bend / 6e-8; else if (third == "N") out = f; else out = bend
        printf "%.3f %.9e %.9e\n", t, 5e-5 - tip - bend, out } }'
}
cantilever "seriesTime height vDeflection" "s m N" N >tip_n.txt
cantilever "seriesTime height vDeflection" "s m V" V >tip_v.txt
cantilever "seriesTime height vDeflection" "s m m" m >tip_m.txt
expect 0 import tip_n.txt tip_v.txt tip_m.txt --specimen-height-mm 0.01 --contact start --out tip
for way in n v m; do
    near "tip_$way: depth" "$(tail -n 1 tip/tip_$way.csv | cut -d, -f2)" 0.003 1e-6
    near "tip_$way: force" "$(tail -n 1 tip/tip_$way.csv | cut -d, -f3)" 1e-8 1e-6
done
expect 0 import tip_m.txt --specimen-height-mm 0.01 --contact start --spring-N-m 0.4 --out tip --force
near "--spring-N-m" "$(tail -n 1 tip/tip_m.csv | cut -d, -f3)" 1e-7 1e-6
expect 0 import tip_n.txt --specimen-height-mm 0.01 --out tip --force
near "tip: contact" "$(key tip/tip_n.csv contact.depth_mm)" -0.05 0 6e-5 # half the window

# ---- a rheometer's gap is the height where it touches; stress and strain; an area ----
awk "$press"'print "Time [s]|Gap [mm]|Normal force [N]"; for (k = 0; k <= 70; k++) { press(k); printf "%.1f|%.4f|%.6f\n", t, 12.5 - d, f } }' >gap.txt
expect 0 import gap.txt --out made
same made/gap.csv 71
[ "$(key made/gap.csv specimen.height_mm)" = 12.5 ] || fail "gap: $(key made/gap.csv specimen.height_mm)"
awk "$press"'print "Anfangsh\366he;20,0;mm\nFl\344che;50,0;mm\262\n\nZeit;Spannung;Stauchung\ns;kPa;%"; for (k = 0; k <= 70; k++) { press(k); s = sprintf("%.1f;%.6f;%.6f", t, f / 50 * 1000, d / 20 * 100); gsub(/\./, ",", s); print s } }' >stress.csv
expect 0 import stress.csv --out made
same made/stress.csv 71
near "stress: radius" "$(key made/stress.csv specimen.radius_mm)" 3.98942280401433 1e-12 # sqrt(50 / pi)
sed 's/^Fl.*//' stress.csv >area.csv
expect 1 import area.csv --out made; says "give --specimen-radius-mm or --specimen-area-mm2"
expect 0 import area.csv --specimen-area-mm2 50 --out made
same made/area.csv 71

# ---- whole numbers whose thousands have points; units behind the numbers; a stretch ----
awk 'function group(x) { x = sprintf("%.0f", x); return length(x) > 3 ? substr(x, 1, length(x) - 3) "." substr(x, length(x) - 2) : x }
    '"$press"'print "Zeit (ms);Weg (\302\265m);Kraft (\302\265N)"; for (k = 0; k <= 70; k++) { press(k); printf "%s;%s;%s\n", group(1000 * t), group(1000 * d), group(1000 * f) } }' >points.csv
expect 0 import points.csv --specimen-height-mm 20 --out made
near "points: depth" "$(tail -n 1 made/points.csv | cut -d, -f2)" 3 0
near "points: force" "$(tail -n 1 made/points.csv | cut -d, -f3)" 0.003149 1e-9
awk "$press"'print "Zeit;Weg;Kraft"; for (k = 0; k <= 70; k++) { press(k); s = sprintf("%.1f s;%.4f mm;%.6f N", t, d, f); gsub(/\./, ",", s); print s } }' >cells.csv
expect 0 import cells.csv --specimen-height-mm 20 --out made
same made/cells.csv 71
awk "$press"'print "Time (s),Stretch (-),Stress (Pa)"; for (k = 0; k <= 70; k++) { press(k); printf "%.1f,%.8f,%.4f\n", t, 1 - d / 20, -f * 1e6 / 50 } }' >stretch.csv
expect 0 import stretch.csv --specimen-height-mm 20 --specimen-area-mm2 50 --out made
same made/stretch.csv 71
near "stretch: contact" "$(key made/stretch.csv contact.depth_mm)" 0 0 1e-12

# ---- a clock over midnight, names between blanks, a fault within ----
awk "$press"'print "Time        Position (mm)   Force (N)"; for (k = 0; k <= 70; k++) { press(k); s = (86397 + t) % 86400
    printf "%02d:%02d:%06.3f   %.4f   %.6f\n", s / 3600, s / 60 % 60, s % 60, d, f; if (k == 30) print "*** overload ***" } }' >night.txt
expect 0 import night.txt --specimen-height-mm 20 --out made
same made/night.csv 71

# ---- eight times the same press but for the noise, every second one without half of its samples: one rule, one contact ----
mkdir again
for i in 1 2 3 4 5 6 7 8; do
    awk -v i=$i 'function normal() { return sqrt(-2 * log(1 - rand())) * cos(6.283185307 * rand()) } BEGIN { srand(i); print "Time (s),Position (mm),Force (N)"
        for (k = 0; k < 1400; k++) { t = k / 200; d = t < 0.5 ? -0.3 : t < 1.6 ? -0.3 + 3 * (t - 0.5) : 3; x = d > 0 ? d : 0
            f = 0.4 * x ^ 1.5 * (t < 1.6 ? 1 : 0.6 + 0.4 * exp(1.6 - t)) + 0.25 + 0.01 * normal()
            if (i % 2 || rand() < 0.5) printf "%.3f,%.4f,%.6f\n", t, d + 30, f } }' >again/run$i.csv
done
expect 0 import again/*.csv --specimen-height-mm 20 --out alike
for run in alike/*.csv; do
    [ "$(key $run contact.rule)" = '"free_air"' ] && [ "$(key $run protocol.kind)" = '"ramp_hold"' ] || fail "$run: $(key $run contact.rule)"
    near "$run: contact" "$(key $run contact.depth_mm)" 30 0 0.15
    near "$run: contact by its sd" "$(key $run contact.depth_mm)" 30 0 "$(awk -v s="$(key $run contact.sd_mm)" 'BEGIN { print 4 * s }')"
    near "$run: zero" "$(key $run contact.zero_N)" 0.25 0 0.006
done
[ "$(grep -c "samples are missing (5\|samples are missing (4" err)" -eq 4 ] || fail "missing samples are not said"

# ---- the unit of force, length and time changes nothing but the numbers ----
for scale in "1e-9 1 1" "1e3 1 1" "1 1e-4 1" "1 10 1" "1 1 1e-3" "1 1 1e3"; do
    set -- $scale
    awk -F, -v f=$1 -v l=$2 -v t=$3 'NR == 1 { print; next } { printf "%.9g,%.9g,%.9g\n", $1 * t, $2 * l, $3 * f }' again/run1.csv >scaled.csv
    expect 0 import scaled.csv --specimen-height-mm "$(awk -v l=$2 'BEGIN { print 20 * l }')" --out scaled --force
    for key in contact.rule protocol.kind; do
        [ "$(key scaled/scaled.csv $key)" = "$(key alike/run1.csv $key)" ] || fail "scales $scale: $key $(key scaled/scaled.csv $key)"
    done
    near "scales $scale: contact" "$(key scaled/scaled.csv contact.depth_mm)" "$(awk -v l=$2 -v c="$(key alike/run1.csv contact.depth_mm)" 'BEGIN { printf "%.15g", l * c }')" 1e-5
    near "scales $scale: sd" "$(key scaled/scaled.csv contact.sd_mm)" "$(awk -v l=$2 -v c="$(key alike/run1.csv contact.sd_mm)" 'BEGIN { printf "%.15g", l * c }')" 1e-2
    near "scales $scale: zero" "$(key scaled/scaled.csv contact.zero_N)" "$(awk -v f=$1 -v c="$(key alike/run1.csv contact.zero_N)" 'BEGIN { printf "%.15g", f * c }')" 1e-4
done

# ---- sheets, where their helpers are ----
if command -v python3 >/dev/null && command -v xlsx2csv >/dev/null; then
    awk "$press"'print "Name,gel\nHeight (mm),20\n\nTime (s),Displacement (mm),Force (N)"; for (k = 0; k <= 70; k++) { press(k); printf "%.1f,%.4f,%.6f\n", t, d, f } }' >plain.csv
    python3 - <<'PYTHON'
import zipfile
def cell(r, c, text):
    name = "ABCDEFG"[c] + str(r)
    try:
        return '<c r="%s"><v>%r</v></c>' % (name, float(text))
    except ValueError:
        return '<c r="%s" t="inlineStr"><is><t>%s</t></is></c>' % (name, text)
rows = "".join('<row r="%d">%s</row>' % (r, "".join(cell(r, c, t) for c, t in enumerate(line.strip().split(",")) if t)) for r, line in enumerate(open("plain.csv"), 1))
main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
head = '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>'
with zipfile.ZipFile("sheet.xlsx", "w") as z:
    z.writestr("[Content_Types].xml", head + '<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Override PartName="/xl/workbook.xml" ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml"/><Override PartName="/xl/worksheets/sheet1.xml" ContentType="application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml"/></Types>')
    z.writestr("_rels/.rels", head + '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument" Target="xl/workbook.xml"/></Relationships>')
    z.writestr("xl/_rels/workbook.xml.rels", head + '<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" Target="worksheets/sheet1.xml"/></Relationships>')
    z.writestr("xl/workbook.xml", head + '<workbook xmlns="%s" xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/relationships"><sheets><sheet name="Data" sheetId="1" r:id="rId1"/></sheets></workbook>' % main)
    z.writestr("xl/worksheets/sheet1.xml", head + '<worksheet xmlns="%s"><sheetData>%s</sheetData></worksheet>' % (main, rows))
PYTHON
    expect 0 import sheet.xlsx --out made
    same made/sheet.csv 71
    [ "$(key made/sheet.csv specimen.height_mm)" = 20.0 ] || fail "sheet: height"
    mkdir bare && ln -s "$(command -v true)" bare/true
    (PATH=$PWD/bare; expect 1 import sheet.xlsx --out none; exit "$failures") || failures=$((failures + 1))
    (PATH=$PWD/bare; "$PALPATE" import sheet.xlsx --out none) 2>err; grep -q "install xlsx2csv" err || fail "sheet: $(cat err)"
fi
printf '\320\317\021\340\241\261\032\341 not a sheet' >broken.xls
expect 1 import broken.xls --out none
grep -q "xls" err || fail "broken.xls: $(cat err)"

# Chinese and Japanese headings, in UTF-8 and in the encodings of their countries; one NUL byte; the wide brackets.
# press NAME HEAD: 600 rows of a press of 3 mm with 6.45 N.
press() {
    { echo "$2"; awk 'BEGIN { for (i = 0; i < 600; i++) { d = (i - 20) * 0.02; d = d < 0 ? 0 : d > 3 ? 3 : d
        printf "%.3f,%.4f,%.5f\n", i * 0.02, d, 2 * d + 0.05 * d * d + 0.001 * sin(7.3 * i) } }'; } >"$1.csv"
}
# taken NAME: the same rows as of English headings.
taken() {
    expect 0 import "$1.csv" --specimen-height-mm 24 --out east
    sed '/^#/d' "east/$1.csv" | cmp -s - english.rows || fail "$1: $(head -n 3 err) $(sed '/^#/d' "east/$1.csv" | head -n 3)"
}
press english 'time (s),displacement (mm),force (N)'
expect 0 import english.csv --specimen-height-mm 24 --out east && sed '/^#/d' east/english.csv >english.rows
press simplified '时间(秒),位移(mm),力(N)'
press wide '时间（s）,位移（毫米）,试验力（N）'
press japanese '時間(s),変位(mm),荷重(N)'
press traditional '時間(s),變位(mm),試驗力(N)'
for name in simplified wide japanese traditional; do taken $name; done
if printf x | iconv -f GB18030 -t UTF-8 >/dev/null 2>&1; then
    iconv -f UTF-8 -t GB18030 simplified.csv >gbk.csv && taken gbk
    iconv -f UTF-8 -t CP932 japanese.csv >sjis.csv && taken sjis
    iconv -f UTF-8 -t BIG5 traditional.csv >big5.csv && taken big5
fi
{ head -c 1000 simplified.csv && printf '\0' && tail -c +1001 simplified.csv; } >nul.csv
taken nul
grep -q '1 stray NUL' err || fail "a NUL byte is left out silently: $(cat err)"
press stress '时间(s),应变(%),应力(kPa)'
expect 0 import stress.csv --specimen-height-mm 24 --specimen-radius-mm 5 --out east
[ "$(tail -n 1 east/stress.csv | cut -d, -f2)" = 0.72 ] || fail "3 % of 24 mm: $(tail -n 1 east/stress.csv)"

# A muscle stretched to three times its length.
awk 'BEGIN { print "Time (s),Stretch (-),Force (N)"; for (i = 0; i < 200; i++) printf "%g,%g,%g\n", 0.1 * i, 1 + 0.01 * i, 0.02 * i }' >tension.csv
expect 0 import tension.csv --specimen-height-mm 24 --out east
grep -q 'stretched to 2.99 times its height' err || fail "tension: $(cat err)"
done_testing
