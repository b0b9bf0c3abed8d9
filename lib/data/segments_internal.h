/* segments_internal.h: the parts of a path. Internal. */
#ifndef SEGMENTS_INTERNAL_H
#define SEGMENTS_INTERNAL_H

#include <palpate/segments.h>

/* Masks (use[i] = 0) single samples further from both neighbours than sigma noise sds and three times the
 * curve's change there; returns how many. */
size_t segments_mask_spikes(size_t n, const double *force, double noise, double sigma, unsigned char *use);

/* The slopes of lines through a piece's first sample that pass all samples so far within a tolerance. */
typedef struct segments_cone {
    double low, high;
} segments_cone;

segments_cone segments_cone_open(void);
/* Narrows the cone by a sample, so much later and deeper than the first; false: no slope remains. */
bool segments_cone_take(segments_cone *cone, double time, double way, double tolerance);

/* bend[n - 2]: absolute second differences of the path, in the order of the samples. */
void segments_bends(size_t n, const double *depth, double *bend);

/* palp_segments_phases, and stood[n]: for how long the plate stands still; negative where it moves. */
palp_status segments_phases(size_t n, const double *time, const double *depth, const double *force,
                            unsigned char *phase, double *stood);

/* First motion into the specimen, from the larger of the start and 0 to the largest depth: its first and last
 * sample. */
void segments_ramp(size_t n, const double *depth, double deepest, size_t *start, size_t *end);

/* The last sample at the largest depth before withdrawal, or n without one. ramp_end: last sample of the
 * ramp. */
size_t segments_press_end(size_t n, const double *depth, double deepest, size_t ramp_end);

/* Refines contact, its depth and sd from the rise after the air. Unchanged if there are too few samples. */
void segments_refine_contact(const palp_press *press, palp_air *air);

/* Did the plate move through air before contact: by more than 3 sds of contact, and without force? */
bool segments_air_seen(const palp_press *press, const palp_air *air);

enum { SEGMENTS_ORDER_MAX = 10 };

/* palp_segments_smooth_path by a linear prediction of this order, up to SEGMENTS_ORDER_MAX. */
palp_status segments_smooth_by_order(size_t order, size_t n, const double *time, double *depth,
                                     double *noise);

/* Whether sample i is usable: its time is after that of the sample before, and time (s), depth (mm) and force
 * (N) are within 1e12. So sums of squares stay finite. */
bool segments_sample_valid(const double *time, const double *depth, const double *force, size_t i);

#endif
