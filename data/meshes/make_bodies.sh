#!/bin/sh
# make_bodies.sh: meshes sphere.geo, liver.geo and ball.geo (Gmsh), three sizes each, coordinates to six digits.
#   data/meshes/make_bodies.sh [FOLDER]           writes sphere_3.8.msh ... there
#   data/meshes/make_bodies.sh --solid            instead: stiffness (N per unit strain) of the solid, modulus 1 kPa,
#                                                 Poisson's ratio 1/4, flats bonded: CalculiX, quadratic tetrahedra
set -eu
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mesh() { # name size
    gmsh -3 -v 0 -setnumber size "$2" "$here/$1.geo" -o "$work/mesh.msh"
    awk '/^\$Nodes/ { nodes = 1 } /^\$EndNodes/ { nodes = 0 }
        nodes && NF == 3 && /\./ { printf "%.6g %.6g %.6g\n", $1, $2, $3; next } { print }' "$work/mesh.msh" >"$2.part"
    mv "$2.part" "$1_$2.msh"
}

solid() { # name size rim
    gmsh -3 -v 0 -order 2 -setnumber size "$2" -setnumber rim "$3" "$here/$1.geo" -format inp -o "$work/mesh.inp"
    awk '/^\*/ { nodes = /^\*NODE/; cells = /C3D10/
            if (nodes) print "*NODE,NSET=ALL"
            if (cells) print "*ELEMENT,TYPE=C3D10,ELSET=ALL"
            next }
        nodes { split($0, at, ","); y[at[1] + 0] = at[3]; low = at[3] < low ? at[3] : low; high = at[3] > high ? at[3] : high }
        nodes || cells
        END { print "*NSET,NSET=BOTTOM"; for (i in y) if (y[i] < low + 1e-6) print i
            print "*NSET,NSET=TOP"; for (i in y) if (y[i] > high - 1e-6) print i
            print "*MATERIAL,NAME=SOLID\n*ELASTIC\n1e-3,0.25\n*SOLID SECTION,ELSET=ALL,MATERIAL=SOLID\n*STEP\n*STATIC"
            print "*BOUNDARY\nBOTTOM,1,3\nTOP,1,1\nTOP,3,3"
            printf "TOP,2,2,%.9g\n", -1e-3 * (high - low)
            print "*NODE PRINT,NSET=TOP,TOTALS=ONLY\nRF\n*END STEP" }' "$work/mesh.inp" >"$work/deck.inp"
    (cd "$work" && ccx -i deck >log 2>&1)
    awk -v name="$1 $2 $3" '!/force/ && NF == 3 { printf "%s: %.4f N\n", name, -$2 / 1e-3 }' "$work/deck.dat"
}

if [ "${1-}" = --solid ]; then
    for rim in 1 0.6 0.4; do solid sphere 3 $rim; done
    for rim in 3 2 1.5; do solid liver 6 $rim; done
    exit
fi
cd "${1:-$here}"
for size in 4.4 3.8 3.2; do mesh sphere $size; done
for size in 9 7.5 6.5; do mesh liver $size; done
for size in 4 3 2.6; do mesh ball $size; done
