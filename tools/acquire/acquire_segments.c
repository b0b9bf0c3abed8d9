/* acquire_segments.c: protocols as the device's segments. */
#include "acquire.h"

#include <math.h>

static uint32_t whole(double x) {
    return (uint32_t)fmin(fmax(rint(x), 0), 4294967295.0);
}

/* Duration of the segment from the present place. */
static double duration_s(uint8_t kind, double way_mm, const acquire_motion *m) {
    switch (kind) {
    case PALP_WIRE_SEGMENT_MOVE:
        return way_mm / m->rate_mm_s;
    case PALP_WIRE_SEGMENT_HOLD:
        return m->hold_s;
    case PALP_WIRE_SEGMENT_CYCLE:
        return 2 * way_mm / m->rate_mm_s * m->cycles;
    case PALP_WIRE_SEGMENT_SINE:
        return m->cycles / m->frequency_Hz;
    case PALP_WIRE_SEGMENT_FORCE:
        return m->ramp_s + m->duration_s + way_mm / ACQUIRE_SEEK_MM_S;
    default:
        return m->duration_s;
    }
}

/* The end of a force segment is not known in advance. */
static bool add_force(acquire_run *r, double force_N, const acquire_motion *m) {
    palp_wire_segment *s = &r->segment[r->n_segments];
    *s = (palp_wire_segment){.index = (uint8_t)r->n_segments,
                             .kind = PALP_WIRE_SEGMENT_FORCE,
                             .target_nm = (int32_t)lrint(1e6 * force_N),
                             .rate_nm_s = whole(1e6 * force_N / m->ramp_s),
                             .duration_ms = whole(1e3 * m->duration_s),
                             .deepest_nm = isnan(m->deepest_mm) ? 0 : (int32_t)lrint(1e6 * m->deepest_mm)};
    r->press_s += duration_s(PALP_WIRE_SEGMENT_FORCE, fmax(-r->at_mm, 0), m);
    r->at_mm = fmax(r->at_mm, 0);
    r->deepest_mm = fmax(r->deepest_mm, 0);
    r->n_segments++;
    return true;
}

bool acquire_segment_add(acquire_run *r, uint8_t kind, double target_mm, const acquire_motion *m) {
    bool moves = kind == PALP_WIRE_SEGMENT_MOVE || kind == PALP_WIRE_SEGMENT_CYCLE;
    bool waves = kind == PALP_WIRE_SEGMENT_SINE || kind == PALP_WIRE_SEGMENT_SWEEP;
    if (r->n_segments == PALP_WIRE_SEGMENTS)
        return false;
    if (kind == PALP_WIRE_SEGMENT_FORCE)
        return add_force(r, target_mm, m);
    palp_wire_segment *s = &r->segment[r->n_segments];
    *s = (palp_wire_segment){.index = (uint8_t)r->n_segments,
                             .kind = (uint8_t)(moves && r->smooth ? kind | PALP_WIRE_SEGMENT_SMOOTH : kind),
                             .target_nm = (int32_t)lrint(1e6 * target_mm),
                             .acceleration_um_s2 = whole(1e3 * m->acceleration_mm_s2)};
    s->rate_nm_s = moves ? whole(1e6 * m->rate_mm_s) : 0;
    s->frequency_mHz = waves ? whole(1e3 * m->frequency_Hz) : 0;
    s->frequency_end_mHz = kind == PALP_WIRE_SEGMENT_SWEEP ? whole(1e3 * m->frequency_end_Hz) : 0;
    s->cycles = kind == PALP_WIRE_SEGMENT_CYCLE || kind == PALP_WIRE_SEGMENT_SINE ? (uint16_t)m->cycles : 0;
    double seconds = duration_s(kind, fabs(target_mm - r->at_mm), m);
    double low = waves ? r->at_mm - target_mm : moves ? target_mm : r->at_mm;
    double high = waves ? r->at_mm + target_mm : low;
    s->duration_ms = moves || kind == PALP_WIRE_SEGMENT_SINE ? 0 : whole(1e3 * seconds);
    r->highest_mm = fmin(r->highest_mm, low);
    r->deepest_mm = fmax(r->deepest_mm, high);
    r->press_s += seconds;
    r->at_mm = kind == PALP_WIRE_SEGMENT_MOVE ? target_mm : r->at_mm;
    r->n_segments++;
    return true;
}

/* Skips moves and rests of zero length, which the device refuses. */
static void move(acquire_run *r, double to_mm) {
    if (to_mm != r->at_mm)
        acquire_segment_add(r, PALP_WIRE_SEGMENT_MOVE, to_mm, &r->motion);
}

static void dwell(acquire_run *r) {
    if (r->motion.hold_s > 0)
        acquire_segment_add(r, PALP_WIRE_SEGMENT_HOLD, r->at_mm, &r->motion);
}

void acquire_segments_make(acquire_run *r) {
    const acquire_motion *m = &r->motion;
    r->start_mm = r->kind == ACQUIRE_FREE ? -m->air_mm - m->depth_mm : -m->air_mm;
    r->highest_mm = r->deepest_mm = r->at_mm = r->start_mm;
    switch (r->kind) {
    case ACQUIRE_STATIC:
        move(r, m->depth_mm);
        break;
    case ACQUIRE_RAMP_HOLD:
        move(r, m->depth_mm);
        dwell(r);
        break;
    case ACQUIRE_CYCLIC: /* from contact to depth and back to contact */
        move(r, 0);
        acquire_segment_add(r, PALP_WIRE_SEGMENT_CYCLE, m->depth_mm, m);
        break;
    case ACQUIRE_SINE:
    case ACQUIRE_SWEEP:
        move(r, m->depth_mm);
        dwell(r);
        acquire_segment_add(r, r->kind == ACQUIRE_SINE ? PALP_WIRE_SEGMENT_SINE : PALP_WIRE_SEGMENT_SWEEP,
                            m->amplitude_mm, m);
        break;
    case ACQUIRE_FREE:
        move(r, -m->air_mm);
        dwell(r);
        break;
    case ACQUIRE_SEGMENTS:
    case ACQUIRE_KINDS:
        break;
    }
}

double acquire_run_length_s(const acquire_run *r) {
    return r->motion.air_s + r->press_s + fabs(r->at_mm - r->start_mm) / ACQUIRE_BACK_MM_S +
           r->motion.after_s;
}
