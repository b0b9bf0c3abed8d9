/* contact.h: finds the specimen: advances until the force rises, measures its first tenth of a millimetre. */
#ifndef CONTACT_H
#define CONTACT_H

#include <palpate/wire.h>

typedef enum contact_phase {
    CONTACT_SEEKING,
    CONTACT_MEASURING,
    CONTACT_FOUND,
    CONTACT_MISSED
} contact_phase;

enum {
    CONTACT_AIR_TICKS = 128, /* ticks averaged for the force in the air */
    CONTACT_FILTER_TICKS = 16
};
#define CONTACT_FREE_M 2e-5f   /* travel before averaging begins, after friction has reversed */
#define CONTACT_AIR_M 1.7e-4f  /* least travel in the air before the threshold is reached */
#define CONTACT_DEPTH_M 1e-4f  /* length of the line, from where the threshold was reached */
#define CONTACT_MOST_M 3e-4f   /* the same if noise hides the slope; beyond it a drift could look like one */
#define CONTACT_SURE_SD 10.0f  /* a slope of so many standard deviations needs no longer line */
#define CONTACT_LEAST_SD 5.0f  /* least standard deviations of a slope at the longest line */
#define CONTACT_FORCE_N 1.0f   /* force beyond the threshold that ends the line: a hard specimen */
#define CONTACT_RIGID_N_M 1e6f /* stiffness reported if the specimen is too stiff to measure */

typedef struct contact {
    contact_phase phase;
    float threshold_N, end_m; /* where the search ends without contact */
    float force_N;            /* above that in air, filtered over a few ticks */
    float zero_N;             /* force in the air: mean of the first ticks of the approach */
    float scatter_N2;         /* sum of squared deviations from it */
    uint32_t ticks;           /* number of these ticks */
    bool begun;
    uint8_t reason;  /* palp_wire_search: why no contact was found */
    float begun_m;   /* where the search began */
    float touched_m; /* where the threshold was reached */
    /* least squares of force against position, both from there on */
    float n, sum_x, sum_f, sum_xx, sum_xf, sum_ff;
    float position_m;    /* found: where the line meets zero force */
    float stiffness_N_m; /* found: its slope */
} contact;

void contact_begin(contact *c, float threshold_N, float end_m);
/* One tick of the approach; returns the phase after it. CONTACT_FOUND needs air first, then a positive slope
 * of five standard deviations. After CONTACT_MISSED, reason says which was lacking. */
contact_phase contact_step(contact *c, float position_m, float force_N);
float contact_noise_N(const contact *c); /* sd of the force in the air, after its average */

#endif
