# runs.awk: runs of a specimen whose force over depth is a table (depth_mm,force_N, even steps): four ramps with a hold and
# the way back, OUT1.csv to OUT4.csv. An effect may be hidden in them; nothing of palpate computes it.
#   awk -v out=PREFIX [-v kind=EFFECT -v size=SIZE] [-v noise=N -v seed=S] -f runs.awk table.csv
# frame_compliance mm/N, contact_offset mm, sensor_lag s, sensor_drift N/s, sensor_gain as a share, coulomb_friction N.
BEGIN { FS = ","; srand(seed); PI = atan2(0, -1) }
FNR > 1 { depth[n] = $1; force[n++] = $2 }

# The slope at a row, over one step: of the parabola through three rows.
function slope(i) {
    return i < 1 ? 2 * force[1] - force[2] / 2 : i > n - 2 ? force[n - 1] - force[n - 2] : (force[i + 1] - force[i - 1]) / 2
}

# Cubic between the rows.
function press(d,   i, s) {
    if (d <= 0) return 0
    i = int(d / depth[1]); if (i > n - 2) i = n - 2
    s = d / depth[1] - i
    return force[i] * (1 + 2 * s) * (1 - s) ^ 2 + slope(i) * s * (1 - s) ^ 2 + force[i + 1] * s * s * (3 - 2 * s) + slope(i + 1) * s * s * (s - 1)
}

# The depth of the surface, of what the encoder reads.
function surface(d,   s, k) {
    if (kind == "contact_offset") return d - size
    for (s = d; kind == "frame_compliance" && k < 60; k++) s += 0.5 * (d - size * press(s) - s)
    return s
}

function noisy() { return noise > 0 ? noise * sqrt(-2 * log(1 - rand())) * cos(2 * PI * rand()) : 0 }

function run(number, deep, rate, hold,   file, up, i, t, d, f, before, felt, keep, lead) {
    file = out number ".csv"
    printf "# palpate.experiment: 1\n# specimen.height_mm: 24\ntime_s,depth_mm,force_N\n" >file
    up = (deep + 1) / rate
    for (i = 0; i <= 10 * (2 * up + hold); i++) {
        t = i / 10
        d = t < up ? t * rate - 1 : t < up + hold ? deep : deep - (t - up - hold) * rate
        f = press(surface(d))
        if (kind == "coulomb_friction") f += t <= up ? size : t > up + hold ? -size : 0
        if (kind == "sensor_lag") { # exact for a force that is linear between the samples
            keep = exp(-0.1 / size); lead = size / 0.1 * (1 - keep)
            felt = i ? keep * felt + (1 - lead) * f + (lead - keep) * before : f
            before = f; f = felt
        }
        if (kind == "sensor_gain") f *= 1 + size
        if (kind == "sensor_drift") f += size * t
        printf "%.9g,%.9g,%.9g\n", t, d, f + noisy() >file
    }
    close(file)
}
END { run(1, 4.8, 1, 6); run(2, 7.2, 3, 6); run(3, 9.6, 0.5, 6); run(4, 9.6, 6, 6) }
