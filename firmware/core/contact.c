/* contact.c: finds the specimen: advances until the force rises, measures its first tenth of a millimetre. */
#include "contact.h"

void contact_begin(contact *c, float threshold_N, float end_m) {
    *c = (contact){.phase = CONTACT_SEEKING, .threshold_N = threshold_N, .end_m = end_m};
}

static contact_phase missed(contact *c, palp_wire_search reason) {
    c->reason = (uint8_t)reason;
    return CONTACT_MISSED;
}

static contact_phase found(contact *c, float position_m, float stiffness_N_m) {
    c->position_m = position_m;
    c->stiffness_N_m = stiffness_N_m < CONTACT_RIGID_N_M ? stiffness_N_m : CONTACT_RIGID_N_M;
    return CONTACT_FOUND;
}

/* Fits a line to the samples; it is extended while noise hides its slope. The slope's variance is
 * residual / ((n - 2) xx). Positions are relative to touched_m, to avoid cancellation. */
static contact_phase fit(contact *c, bool hard, bool over) {
    float mean_x = c->sum_x / c->n, mean_f = c->sum_f / c->n;
    float xx = c->sum_xx - mean_x * c->sum_x, xf = c->sum_xf - mean_x * c->sum_f;
    float ff = c->sum_ff - mean_f * c->sum_f;
    if (c->n > 3.0f && xx > 1e-12f && xf > 0.0f) {
        float slope = xf / xx, residual = ff - slope * xf,
              sds = hard || over ? CONTACT_LEAST_SD : CONTACT_SURE_SD;
        if (slope * xf * (c->n - 2.0f) > sds * sds * residual)
            return found(c, c->touched_m + mean_x - mean_f / slope, slope);
    }
    if (hard)
        return found(c, c->touched_m, CONTACT_RIGID_N_M);
    return over ? missed(c, PALP_WIRE_SEARCH_NO_SLOPE) : CONTACT_MEASURING;
}

static contact_phase measure(contact *c, float position_m, float force_N) {
    float x = position_m - c->touched_m, f = force_N - c->zero_N;
    bool hard = f > c->threshold_N + CONTACT_FORCE_N, over = x >= CONTACT_MOST_M || position_m >= c->end_m;
    c->n += 1.0f;
    c->sum_x += x;
    c->sum_f += f;
    c->sum_xx += x * x;
    c->sum_xf += x * f;
    c->sum_ff += f * f;
    return hard || over || x >= CONTACT_DEPTH_M ? fit(c, hard, over) : CONTACT_MEASURING;
}

static contact_phase seek(contact *c, float position_m, float force_N) {
    if (!c->begun)
        c->begun_m = position_m;
    c->begun = true;
    if (c->ticks == 0 && position_m < c->begun_m + CONTACT_FREE_M && position_m < c->end_m)
        return CONTACT_SEEKING;
    c->ticks++;
    if (c->ticks <= CONTACT_AIR_TICKS) {
        const float off_N = force_N - c->zero_N;
        c->zero_N += off_N / (float)c->ticks;
        c->scatter_N2 += off_N * (force_N - c->zero_N);
    }
    c->force_N += (force_N - c->zero_N - c->force_N) / (float)CONTACT_FILTER_TICKS;
    if (c->force_N < c->threshold_N)
        return position_m < c->end_m ? CONTACT_SEEKING : missed(c, PALP_WIRE_SEARCH_NOTHING);
    if (c->ticks <= CONTACT_AIR_TICKS || position_m < c->begun_m + CONTACT_AIR_M)
        return missed(c, PALP_WIRE_SEARCH_NO_AIR);
    c->touched_m = position_m;
    return measure(c, position_m, force_N);
}

contact_phase contact_step(contact *c, float position_m, float force_N) {
    if (c->phase == CONTACT_SEEKING)
        c->phase = seek(c, position_m, force_N);
    else if (c->phase == CONTACT_MEASURING)
        c->phase = measure(c, position_m, force_N);
    return c->phase;
}

float contact_noise_N(const contact *c) {
    return __builtin_sqrtf(c->scatter_N2 / (float)(CONTACT_AIR_TICKS - 1));
}
