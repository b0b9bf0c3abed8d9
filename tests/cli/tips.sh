#!/bin/sh
# tips.sh: presses with a flat punch, a sphere and a plate give the moduli of the layer; one tip gives no Poisson's ratio.
. tests/cli/common

# press NAME K_N EXPONENT HEIGHT DEPTH LENGTH LINES: force K ((d / 1 mm)^EXPONENT) of a solid that relaxes to a half with 4 s, of a
# ramp of 1 s to DEPTH mm and a hold of 30 s; all depths times LENGTH; LINES in the header.
press() {
    { echo '# palpate.experiment: 1'; echo "# specimen.height_mm: $(awk "BEGIN { print $4 * $6 }")"; printf '%b' "$7"; echo 'time_s,depth_mm,force_N'
    awk -v k="$2" -v p="$3" -v top="$5" -v l="$6" 'BEGIN { srand(3)
        for (i = 0; i <= 1600; i++) {
            t = (i - 50) / 50; d = top * (t < 1 ? t : 1); x = d > 0 ? d ^ p : 0
            if (i) { e = exp(-0.02 / 4); q = q * e + (x - was) * 4 / 0.02 * (1 - e) } was = x
            printf "%.3f,%.9g,%.9g\n", i / 50, d * l, k * (x + q + 0.001 * top ^ p * (rand() + rand() + rand() - 1.5)) }
    }'; } >"$1.csv"
}
modulus() { awk -v n="\"$1\":" -v k="\"${2-value}\":" '$1 == n { on = 1 } on && $1 == k { sub(",", "", $2); print $2; exit }' out; }

# Hayes and others 1972, nu 0.5, a / h 0.2 and 1: F = 4 G a kappa d / (1 - nu), kappa 1.281 and 3.609; G = 1000 Pa, h = 10 mm.
tip='# tip.kind: "flat"\n# tip.radius_mm: '
press narrow "$(awk 'BEGIN { print 4 * 1000 * 2e-3 * 1.281 * 1e-3 / 0.5 }')" 1 10 0.5 1 "${tip}2\n"
press broad "$(awk 'BEGIN { print 4 * 1000 * 10e-3 * 3.609 * 1e-3 / 0.5 }')" 1 10 0.5 1 "${tip}10\n"
expect 0 characterize broad.csv --arms 1 --small-strain --json
near "G_inf of a flat punch" "$(modulus shear_inf_Pa)" 1000 0.01
near "G_0" "$(modulus shear_0_Pa)" 2000 0.01
near "E_inf" "$(modulus young_inf_Pa)" 3000 0.01
grep -q '"poisson_found": false' out || fail "one tip gave a Poisson's ratio"
grep -q 'one tip .* cannot identify both modulus and Poisson' err || fail "it is not said that one tip cannot give both"
awk -v a="$(modulus shear_inf_Pa low)" -v b="$(modulus shear_inf_Pa high)" 'BEGIN { exit !(a < b && b - a < 100) }' || fail "no interval"
# Three specimens of 900, 1000 and 1100 Pa: each by its own runs, their mean with Student's interval, 100 Pa times 4.303 / sqrt 3.
for g in 900 1000 1100; do
    press "of$g" "$(awk -v g=$g 'BEGIN { print 4 * g * 10e-3 * 3.609 * 1e-3 / 0.5 }')" 1 10 0.5 1 "${tip}10\n# specimen.name: \"gel $g\"\n"
    cp "of$g.csv" "again$g.csv"
done
expect 0 characterize of*.csv again*.csv --arms 1 --small-strain --json
grep -q '3 specimens under a tip: their moduli are pooled' err || fail "specimens under a tip: $(cat err)"
[ "$(grep -c '"name": "gel ' out)" -ge 3 ] || fail "not three specimens"
awk '/"moduli"/ { on = 1 } on && /"specimens"/ { inside = 1 } inside && $1 == "\"value\":" { sub(",", "", $2); print $2 } inside && /^ *\],?$/ { exit }' out | awk 'NR % 2' | sort -n >each
awk '{ w = 800 + 100 * NR; if ($1 / w - 1 > 0.01 || $1 / w - 1 < -0.01) bad = 1 } END { exit bad || NR != 3 }' each || fail "specimens: $(tr '\n' ' ' <each)"
tail -n +"$(grep -n '"floor"' out | cut -d: -f1)" out >mean && cp mean out
near "mean of the specimens" "$(modulus shear_inf_Pa)" 1000 0.01
near "half of its interval" "$(awk -v a="$(modulus shear_inf_Pa low)" -v b="$(modulus shear_inf_Pa high)" 'BEGIN { print (b - a) / 2 }')" 248.4 0.03
expect 0 characterize broad.csv narrow.csv --arms 1 --small-strain --json
grep -q '"poisson_found": true' out || fail "two tips gave no Poisson's ratio"
near "nu of two punches" "$(modulus poisson)" 0.5 0.01
near "their G_inf" "$(modulus shear_inf_Pa)" 1000 0.02
expect 0 characterize broad.csv narrow.csv --arms 1 --small-strain
grep -q "Poisson's ratio *0.*from 2 tips of different size" out || fail "print: $(grep Poisson out)"
expect 0 characterize broad.csv --arms 1 --small-strain --poisson 0.3
grep -q "Poisson's ratio *0.300   assumed" out || fail "print: $(grep Poisson out)"
grep -q 'cannot identify both' err && fail "a ratio that is given is warned of"

press ball "$(awk 'BEGIN { print 8 / 3 * 5000 * sqrt(5e-3) * 1e-3 ^ 1.5 / 0.6 }')" 1.5 1000 0.3 1 ''
# What a flat punch meets beyond: a neo-Hookean layer is stiffer, a narrow specimen softer, a punch that sticks stiffer.
expect 0 characterize broad.csv --arms 1 --json
awk -v g="$(modulus shear_inf_Pa)" 'BEGIN { exit !(g > 920 && g < 960) }' || fail "large strain: $(modulus shear_inf_Pa)"
grep -q '"large_strain": true' out || fail "large strain is not said"
expect 0 characterize broad.csv --arms 1 --small-strain --tip-sticks --json
near "G of a punch that sticks" "$(modulus shear_inf_Pa)" "$(awk 'BEGIN { print 1000 / 1.129 }')" 0.01
sed 's/"flat"/&\n# specimen.radius_mm: 15/' broad.csv >edge.csv
expect 0 characterize edge.csv --arms 1 --small-strain --json
near "G of a specimen half as wide again as the punch" "$(modulus shear_inf_Pa)" "$(awk 'BEGIN { print 1000 / 0.712 }')" 0.01
sed 's/radius_mm: 10/radius_mm: 1/' broad.csv >thin.csv
expect 0 characterize thin.csv --arms 1
grep -q 'not corrected for large strain' err || fail "beyond the table: $(cat err)"
grep -q 'small strain; the tip slides' out || fail "print: $(grep Moduli out)"
expect 1 characterize thin.csv --tip-sticks; grep -q 'is tabulated for punches' err || fail "$(tail -n 1 err)"
expect 1 characterize ball.csv --tip sphere --tip-radius-mm 5 --tip-sticks; grep -q 'needs a plate, or a flat punch' err || fail "$(tail -n 1 err)"

# Lengths times 1e-3: the same force is of a modulus 1e6 times as large.
press tiny "$(awk 'BEGIN { print 4 * 1000 * 10e-3 * 3.609 * 1e-3 / 0.5 }')" 1 10 0.5 1e-3 "${tip}0.01\n"
expect 0 characterize broad.csv --arms 1 --small-strain --json; one=$(modulus shear_inf_Pa)
expect 0 characterize tiny.csv --arms 1 --small-strain --json
near "G of a thousandth of the size" "$(modulus shear_inf_Pa)" "$(awk "BEGIN { print 1e6 * $one }")" 1e-4

# Hertz on a thick layer: F = 8 / 3 G sqrt(R) d^1.5 / (1 - nu); contact is found with the modulus.
expect 0 characterize ball.csv --arms 1 --tip sphere --tip-radius-mm 5 --poisson 0.4 --json
near "G_inf of a sphere" "$(modulus shear_inf_Pa)" 5000 0.03
# A sphere pressed deep: CalculiX' force with radius and thickness 10 mm, ratio 0.3, at 1 mm, is 5.3 % above that of small strain; what its power is not
# the residual has. Beyond the tables nothing is corrected, which is said where it matters.
press deep "$(awk 'BEGIN { print 1000 * 0.1726 * 1e-4 }')" 1.5 10 1 1 ''
expect 0 characterize deep.csv --arms 1 --tip sphere --tip-radius-mm 10 --poisson 0.3 --contact known --json
near "G_inf of a sphere pressed deep" "$(modulus shear_inf_Pa)" 1000 0.02; corrected=$(modulus shear_inf_Pa)
grep -q '"large_strain": true' out || fail "large strain of a sphere is not said"
grep -q 'small-strain moduli' err && fail "warned of small strain: $(cat err)"
expect 0 characterize deep.csv --arms 1 --tip sphere --tip-radius-mm 10 --poisson 0.3 --contact known --small-strain --json
awk -v g="$(modulus shear_inf_Pa)" -v c="$corrected" 'BEGIN { exit !(g > 1.04 * c && g < 1.06 * c) }' || fail "a sphere at small strain: $(modulus shear_inf_Pa) for $corrected"
grep -q 'small-strain moduli are wrong' err || fail "no warning of small strain: $(cat err)"
expect 0 characterize deep.csv --arms 1 --tip sphere --tip-radius-mm 2 --poisson 0.3 --contact known
grep -q 'not corrected for large strain: .* spheres' err || fail "beyond the sphere's table: $(cat err)"

# A plate that slides: E = F h / (A d).
press plate "$(awk 'BEGIN { print 3 * 4000 * 3.14159265 * 0.01 ^ 2 / 0.02 * 1e-3 }')" 1 20 1 1 '# specimen.radius_mm: 10\n'
expect 0 characterize plate.csv --arms 1 --tip plate --json
near "E_inf of a plate" "$(modulus young_inf_Pa)" 12000 0.01
expect 0 characterize plate.csv --arms 1 --json
grep -q '"moduli": null' out || fail "moduli without a tip"

expect 1 characterize plate.csv --tip sphere; grep -q 'a sphere tip needs --tip-radius-mm' err || fail "$(tail -n 1 err)"
expect 1 characterize ball.csv --tip plate; grep -q "a plate tip needs the specimen's radius" err || fail "$(tail -n 1 err)"
expect 1 characterize ball.csv --tip cone; grep -q 'a cone tip needs --tip-angle-deg' err || fail "$(tail -n 1 err)"
expect 1 characterize broad.csv ball.csv --arms 1; grep -q 'give --tip for all' err || fail "$(tail -n 1 err)"
expect 2 characterize ball.csv --tip needle
expect 2 characterize ball.csv --tip flat --poisson 0.6
sed 's/"flat"/"needle"/' broad.csv >needle.csv
expect 1 characterize needle.csv; grep -q 'tip.kind is "needle"' err || fail "$(tail -n 1 err)"
expect 1 characterize broad.csv --tip flat --tip-radius-mm 500; grep -q 'give --tip plate' err || fail "$(tail -n 1 err)"
done_testing
