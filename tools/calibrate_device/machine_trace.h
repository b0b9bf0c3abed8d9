/* machine_trace.h: the tools of a calibration step: recorded samples, a least-squares line, its interval. */
#ifndef PALPATE_MACHINE_TRACE_H
#define PALPATE_MACHINE_TRACE_H

#include "acquire/acquire_session.h"

typedef struct machine_sample {
    uint32_t tick;
    int32_t position; /* counts */
    int16_t adc[PALP_WIRE_CHANNELS], duty, error;
    uint8_t state;
    uint16_t flags;
} machine_sample;

typedef struct machine_trace {
    bool on, full; /* full: out of memory; later samples are missing */
    size_t n, room;
    machine_sample *list;
} machine_trace;

/* An observer of a session; its context is a machine_trace. */
void machine_trace_heard(const session *s, const palp_wire_message *m, void *context);
void machine_trace_free(machine_trace *t);

/* A value with the half-width of its 95 % interval. */
typedef struct machine_figure {
    double value, half;
} machine_figure;

enum { MACHINE_TERMS = 4 };

/* y = sum of coefficients times x[i][], by least squares. half: Student's t times the standard error, with
 * the residual's sd at least sd. False: the points do not determine the coefficients. residual (may be NULL):
 * y minus the line. */
bool machine_fit(size_t n, size_t terms, double (*x)[MACHINE_TERMS], const double *y, double sd,
                 machine_figure *coefficient, double *residual);

#endif
