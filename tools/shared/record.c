/* record.c: a force curve that grows as it is made. */
#include "record.h"

#include <math.h>
#include <palpate/path.h>
#include <stdlib.h>
#include <string.h>

static palp_status grow(record *curve) {
    size_t capacity = curve->capacity ? 2 * curve->capacity : 256;
    double **arrays[3] = {&curve->time_s, &curve->depth_m, &curve->force_N};
    for (int i = 0; i < 3; i++) {
        double *larger = realloc(*arrays[i], capacity * sizeof *larger);
        if (!larger)
            return PALP_ERR_NO_MEMORY;
        *arrays[i] = larger;
    }
    curve->capacity = capacity;
    return PALP_OK;
}

palp_status record_add(record *curve, double time_s, double depth_m, double force_N) {
    size_t at = curve->n;
    if (at > 0 && curve->time_s[at - 1] >= time_s) {
        at--;
    } else if (at == curve->capacity) {
        palp_status status = grow(curve);
        if (status)
            return status;
    }
    curve->time_s[at] = time_s;
    curve->depth_m[at] = depth_m;
    curve->force_N[at] = force_N;
    curve->n = at + 1;
    return PALP_OK;
}

void record_free(record *curve) {
    free(curve->time_s);
    free(curve->depth_m);
    free(curve->force_N);
    memset(curve, 0, sizeof *curve);
}

double record_peak(const record *curve) {
    double peak = 0;
    for (size_t i = 0; i < curve->n; i++)
        peak = fmax(peak, fabs(curve->force_N[i]));
    return peak;
}

double record_at(const record *curve, double t) {
    const palp_path path = {.n = curve->n, .time_s = curve->time_s, .force_N = curve->force_N};
    return palp_path_at(&path, t);
}
