/* recording_internal.h: the steps of preparing a recording, in order. Internal. */
#ifndef RECORDING_INTERNAL_H
#define RECORDING_INTERNAL_H

#include <palpate/recording.h>

/* Masks stretches at exactly the largest force, if they are at least this share of the samples. */
void recording_mask_clipped(palp_recording *r, double share);

/* Finds contact and zero force, without subtracting them. In: r->contact_sd_m of the nominal contact, 0 =
 * unknown. */
void recording_find_contact(palp_recording *r, const palp_recording_settings *settings);

/* Samples first to end - 1, which count or only carry the path. */
typedef struct recording_block {
    size_t first, end;
    bool counts;
} recording_block;

/* Cuts a recording into block[*n], rec->n at most, parts as of palp_recording_blocks. counts[rec->n]: which
 * samples do. What does not count, or ends at a corner, leaves its last sample for the path. */
palp_status recording_cut(const palp_recording *rec, double parts, const unsigned char *counts, size_t *n,
                          recording_block *block);

/* Noise of the force in the still part at the end: correlation between samples, mains hum. */
palp_status recording_look_at_noise(palp_recording *r, double step_s);

#endif
