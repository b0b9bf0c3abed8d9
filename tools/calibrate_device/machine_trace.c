/* machine_trace.c: samples of a step, and a line through points. */
#include "machine_trace.h"

#include <math.h>
#include <palpate/random.h>
#include <stdlib.h>

enum { FIRST_ROOM = 4096 };

static bool grow(machine_trace *t) {
    const size_t room = t->room ? 2 * t->room : FIRST_ROOM;
    machine_sample *list = realloc(t->list, room * sizeof *list);
    t->full = !list;
    t->list = list ? list : t->list;
    t->room = list ? room : t->room;
    return list != NULL;
}

void machine_trace_heard(const session *s, const palp_wire_message *m, void *context) {
    machine_trace *t = context;
    const palp_wire_samples *b = &m->as.samples;
    (void)s;
    for (uint32_t i = 0; m->type == PALP_WIRE_TYPE_SAMPLES && t->on && !t->full && i < b->count; i++) {
        if (t->n == t->room && !grow(t))
            return;
        machine_sample *one = &t->list[t->n++];
        *one = (machine_sample){.tick = b->tick + i,
                                .position = b->position[i],
                                .duty = b->duty[i],
                                .error = b->error[i],
                                .state = b->state,
                                .flags = b->flags[i]};
        for (size_t c = 0; c < PALP_WIRE_CHANNELS; c++)
            one->adc[c] = b->adc[PALP_WIRE_CHANNELS * i + c];
    }
}

void machine_trace_free(machine_trace *t) {
    free(t->list);
    *t = (machine_trace){.n = 0};
}

typedef struct normal {
    size_t n;
    double a[MACHINE_TERMS][MACHINE_TERMS], inverse[MACHINE_TERMS][MACHINE_TERMS];
} normal;

/* LAPACK's: Cholesky factor of the lower triangle, by columns, and the inverse from it. */
void dpotrf_(const char *half, const int *n, double *a, const int *lda, int *info);
void dpotri_(const char *half, const int *n, double *a, const int *lda, int *info);

/* Inverts the normal matrix, scaled to a unit diagonal. */
static bool invert(normal *m) {
    const int n = (int)m->n, lda = MACHINE_TERMS;
    int info;
    for (size_t i = 0; i < m->n; i++)
        for (size_t j = 0; j < m->n; j++)
            m->inverse[i][j] = m->a[i][j] / sqrt(m->a[i][i] * m->a[j][j]);
    dpotrf_("L", &n, m->inverse[0], &lda, &info);
    for (size_t k = 0; k < m->n && info == 0; k++)
        info = m->inverse[k][k] * m->inverse[k][k] > 1e-10 ? 0 : 1; /* not so a NaN */
    if (info == 0)
        dpotri_("L", &n, m->inverse[0], &lda, &info);
    for (size_t j = 0; j < m->n; j++)
        for (size_t i = j; i < m->n; i++)
            m->inverse[i][j] = m->inverse[j][i] = m->inverse[j][i] / sqrt(m->a[i][i] * m->a[j][j]);
    return info == 0;
}

bool machine_fit(size_t n, size_t terms, double (*x)[MACHINE_TERMS], const double *y, double sd,
                 machine_figure *c, double *residual) {
    normal m = {.n = terms};
    double right[MACHINE_TERMS] = {0}, square = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < terms; j++) {
            right[j] += x[i][j] * y[i];
            for (size_t k = 0; k < terms; k++)
                m.a[j][k] += x[i][j] * x[i][k];
        }
    if (n <= terms || !invert(&m))
        return false;
    for (size_t j = 0; j < terms; j++) {
        c[j].value = 0;
        for (size_t k = 0; k < terms; k++)
            c[j].value += m.inverse[j][k] * right[k];
    }
    for (size_t i = 0; i < n; i++) {
        double off = y[i];
        for (size_t j = 0; j < terms; j++)
            off -= c[j].value * x[i][j];
        square += off * off;
        if (residual)
            residual[i] = off;
    }
    const double spread = fmax(sd, sqrt(square / (double)(n - terms)));
    for (size_t j = 0; j < terms; j++)
        c[j].half = palp_student_95(n - terms) * spread * sqrt(m.inverse[j][j]);
    return true;
}
