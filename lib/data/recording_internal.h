/* recording_internal.h: the steps that make a recording ready, in the order they are taken. Internal. */
#ifndef RECORDING_INTERNAL_H
#define RECORDING_INTERNAL_H

#include <palpate/recording.h>

/* Mean of the n samples from first on that are in use; 0 if none is. *used: how many, may be NULL. */
double recording_mean(const palp_recording *r, size_t first, size_t n, size_t *used);

/* Stretches at exactly the largest force, at least this share of the samples. */
void recording_mask_clipped(palp_recording *r, double share);

/* Contact and zero force, not yet subtracted; r->contact_sd_m in: of the nominal contact, 0 = not known. */
void recording_find_contact(palp_recording *r, const palp_recording_settings *settings);

/* What is left in the force of the still end: correlation from sample to sample, mains hum. */
palp_status recording_look_at_noise(palp_recording *r, double step_s);

#endif
