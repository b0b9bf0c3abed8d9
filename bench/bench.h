/* bench.h: what the benches share: a clock, medians, the network of the measurements. */
#ifndef BENCH_H
#define BENCH_H

#include <palpate/palpate.h>

double bench_seconds(void);
double bench_cpu_seconds(void); /* of this thread: what others on the machine take is not in it */

/* How often others have been given the processor in place of this thread so far; 0 where the system does not
 * tell. */
long bench_interruptions(void);

/* Sorts x. */
double bench_median(double *x, size_t n);

/* Largest resident memory of this process so far, MB. */
double bench_peak_MB(void);

/* Prints why and exits, unless status is OK. */
void bench_check(palp_status status, const char *what);

/* The quartic law 177.63 e^4 - 124.03 e^3 + 33.25 e^2 - 2.34 e + 0.54 N with n_arms arms (at most 2). */
palp_material bench_material(size_t n_arms);

/* A cube of 24 mm with n nodes a side, or the mesh of a file (n = 0); 26 neighbours, default supports. */
palp_network *bench_network(size_t n, const char *file, const palp_material *material, palp_solver solver);

extern const double BENCH_SIZE; /* m */

#endif
