/* recording_internal.h: the steps of preparing a recording, in order. Internal. */
#ifndef RECORDING_INTERNAL_H
#define RECORDING_INTERNAL_H

#include <palpate/recording.h>

/* Masks stretches at exactly the largest force, if they are at least this share of the samples. */
void recording_mask_clipped(palp_recording *r, double share);

/* Finds contact and zero force, without subtracting them. In: r->contact_sd_m of the nominal contact, 0 =
 * unknown. */
void recording_find_contact(palp_recording *r, const palp_recording_settings *settings);

/* Noise of the force in the still part at the end: correlation between samples, mains hum. */
palp_status recording_look_at_noise(palp_recording *r, double step_s);

#endif
