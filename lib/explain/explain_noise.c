/* explain_noise.c: the white noise of a run, from sample to sample. */
#include "explain_data.h"
#include "data/segments_internal.h"

#include <math.h>
#include <stdlib.h>

/* Equal neighbours at the run's largest force may be clipped. They do not count for the noise, if there are
 * others. */
palp_status explain_white_noise(explain_run *run, const double *x) {
    const size_t n = run->n;
    const double step = (run->time[n - 1] - run->time[0]) / (double)(n - 1);
    double *time = malloc(2 * n * sizeof *time), *rest = time ? time + n : NULL, most = 0.0;
    size_t kept = 0;
    if (!time)
        return PALP_ERR_NO_MEMORY;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fabs(run->force[i]));
    for (size_t i = 0; i < n; i++) {
        const bool alike = (i > 0 && run->force[i - 1] == run->force[i]) ||
                           (i + 1 < n && run->force[i + 1] == run->force[i]);
        if (alike && fabs(run->force[i]) == most)
            continue;
        time[kept] = run->time[i];
        rest[kept++] = x[i];
    }
    const bool some = kept >= EXPLAIN_SAMPLES_MIN;
    palp_status status = palp_segments_noise(some ? kept : n, some ? time : run->time, step, some ? rest : x,
                                             PALP_NOISE_MEDIAN, &run->white);
    free(time);
    return status;
}
