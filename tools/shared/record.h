/* record.h: a force curve that grows as it is made. */
#ifndef PALPATE_RECORD_H
#define PALPATE_RECORD_H

#include <palpate/status.h>
#include <stddef.h>

typedef struct record {
    size_t n, capacity;
    double *time_s, *depth_m, *force_N;
} record;

/* Appends a sample; one at the time of the last replaces it. */
palp_status record_add(record *curve, double time_s, double depth_m, double force_N);
void record_free(record *curve);

double record_peak(const record *curve); /* largest |force| */

/* Force at time t, linear between the samples, constant outside. */
double record_at(const record *curve, double t);

#endif
