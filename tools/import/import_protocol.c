/* import_protocol.c: the kind of motion of the plate, by the options or the recording. */
#include "import.h"

#include <palpate/recording.h>
#include <string.h>

static const char *const protocols[] = {"static", "ramp_hold", "cyclic", "other"};

bool import_is_approach(const import_source *s) {
    return s->format == IMPORT_MACH1 &&
           (import_setting(s, "Contact Criteria, gf") || strcmp(s->block, "Find Contact") == 0);
}

/* "ramp, dwell"; of many pieces each kind once, with its count. */
static void say_pieces(const palp_pieces *pieces, char to[IMPORT_WORD]) {
    size_t count[PALP_MOTION_COUNT] = {0}, length = 0;
    bool few = pieces->n <= 6;
    for (size_t k = 0; k < pieces->n; k++)
        count[pieces->piece[k].motion]++;
    for (size_t k = 0; k < pieces->n && length + 20 < IMPORT_WORD; k++) {
        palp_motion motion = pieces->piece[k].motion;
        if (few || count[motion] > 0) {
            int n = snprintf(to + length, IMPORT_WORD - length, "%s%s", length ? ", " : "",
                             palp_motion_name(motion));
            length += n > 0 ? (size_t)n : 0;
            if (!few && count[motion] > 1) {
                n = snprintf(to + length, IMPORT_WORD - length, " x%zu", count[motion]);
                length += n > 0 ? (size_t)n : 0;
            }
            count[motion] = few ? count[motion] : 0;
        }
    }
}

static const char *of_pieces(const palp_pieces *pieces) {
    static const char *const kinds[] = {"static", "ramp_hold", "other"};
    bool pressed = false;
    for (size_t k = 0; k < pieces->n; k++) {
        palp_motion motion = pieces->piece[k].motion;
        if (motion == PALP_MOTION_CYCLE || motion == PALP_MOTION_SWEEP)
            return motion == PALP_MOTION_CYCLE ? "cyclic" : "sweep";
        pressed = pressed || motion == PALP_MOTION_RAMP || motion == PALP_MOTION_DWELL;
    }
    return pressed ? kinds[palp_recording_kind_of(pieces)] : "free";
}

int import_protocol(const import_options *o, import_source *s) {
    palp_pieces pieces;
    if (palp_segments_clock(s->rows, s->time_s, &s->step_s, &s->lost) ||
        palp_segments_pieces(s->rows, s->time_s, s->depth_mm, &pieces))
        return cli_failure("import", "%s: out of memory", s->file);
    say_pieces(&pieces, s->phases);
    s->protocol = o->protocol >= 0        ? protocols[o->protocol]
                  : import_is_approach(s) ? "free"
                                          : of_pieces(&pieces);
    palp_pieces_free(&pieces);
    return CLI_OK;
}
