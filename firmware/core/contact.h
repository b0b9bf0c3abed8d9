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
    CONTACT_AIR_TICKS = 128, /* averaged for the force in the air */
    CONTACT_FILTER_TICKS = 16
};
#define CONTACT_FREE_M 2e-5f   /* travel before the averaging begins: friction has turned round then */
#define CONTACT_AIR_M 1.7e-4f  /* least travel in the air before the threshold is passed */
#define CONTACT_DEPTH_M 1e-4f  /* of the line, from where the threshold was passed, */
#define CONTACT_MOST_M 3e-4f   /* or to here where noise hides its slope; further on a drift would show one */
#define CONTACT_SURE_SD 10.0f  /* standard deviations: so steep, the line needs no more length; */
#define CONTACT_LEAST_SD 5.0f  /* so steep at its end, it is a line at all */
#define CONTACT_FORCE_N 1.0f   /* or until so much beyond the threshold: something hard stops it at once */
#define CONTACT_RIGID_N_M 1e6f /* stiffness given to what is too hard to measure a line on */

typedef struct contact {
    contact_phase phase;
    float threshold_N, end_m; /* give up there */
    float force_N;            /* over the air's, filtered over a few ticks */
    float zero_N;             /* force in the air, mean of the first ticks on the way, */
    float scatter_N2;         /* and its squared distances from that, summed up */
    uint32_t ticks;           /* of them */
    bool begun;
    uint8_t reason;  /* palp_wire_search: why it was missed */
    float begun_m;   /* where the search began */
    float touched_m; /* where the threshold was passed */
    /* least squares of force against position, both from there on */
    float n, sum_x, sum_f, sum_xx, sum_xf, sum_ff;
    float position_m;    /* found: where the line meets zero force */
    float stiffness_N_m; /* found: its slope */
} contact;

void contact_begin(contact *c, float threshold_N, float end_m);
/* One tick of the advance; the phase afterwards. Found needs a slope that is positive and five times its own
 * standard deviation, and air before it: a search that begins in the specimen misses. After a miss, reason
 * says which of these it was. */
contact_phase contact_step(contact *c, float position_m, float force_N);
float contact_noise_N(const contact *c); /* sd of the force in the air, once that was averaged */

#endif
