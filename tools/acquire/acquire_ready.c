/* acquire_ready.c: preparations of a run: limits and gains, home, tare, contact. */
#include "acquire_session.h"

#include <math.h>
#include <string.h>

enum { TARE_TICKS = 1000 };

static const double SEEK_MM_S = 0.5;

static outcome set_limits(session *s) {
    const acquire_options *o = s->options;
    palp_wire_message m = {.type = PALP_WIRE_TYPE_LIMITS};
    palp_wire_limits *limits = &m.as.limits;
    /* a simulated clock may run many times faster than ours */
    double host_s = o->host_timeout_s > 0 ? o->host_timeout_s : s->device.info.simulated ? 60 : 0;
    limits->force_uN = (int32_t)lrint(1e6 * o->limit_N);
    limits->travel_nm = (int32_t)lrint(1e6 * o->limit_mm);
    limits->temperature_cC = (int16_t)lrint(1e2 * o->limit_C);
    limits->host_timeout_ms = (uint16_t)lrint(1e3 * host_s);
    outcome end = session_order(s, &m, "set its limits");
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_LIMITS}, got = {0};
    end = end ? end : session_ask(s, &ask, &got);
    s->limits = got.as.limits_now;
    return end;
}

static outcome set_calibration(session *s) {
    outcome end = GOES_ON;
    for (uint8_t axis = 0; axis < PALP_WIRE_CHANNELS && end == GOES_ON; axis++) {
        palp_wire_message m = {.type = PALP_WIRE_TYPE_SET_CALIBRATION, .as.set_calibration = {.axis = axis}};
        memcpy(m.as.set_calibration.row, s->options->row[axis], sizeof s->options->row[axis]);
        end = s->options->calibration[axis] ? session_order(s, &m, "take the sensor's calibration") : GOES_ON;
    }
    return end;
}

/* Triggers are off at the start, so a device without triggers gets no command. */
static outcome set_trigger(session *s) {
    const acquire_options *o = s->options;
    palp_wire_message m = {
        .type = PALP_WIRE_TYPE_TRIGGER,
        .as.trigger = {(uint8_t)o->trigger_in, o->trigger_out, (uint16_t)o->trigger_every}};
    return o->trigger_in || o->trigger_out ? session_order(s, &m, "take the triggers") : GOES_ON;
}

/* Reads the parameters, which the header of each recording names. */
static outcome read_calibration(session *s) {
    enum { CALIBRATED = 13 }; /* of the parameters up to moving_kg, which come first */
    outcome end =
        session_from_device(s, device_parameters_read(&s->device, CALIBRATED, &s->calibration), "answer");
    if (end == GOES_ON && s->calibration.now.source == 2)
        session_tell(
            s, true,
            "the device's saved parameters are damaged, so it uses the compiled-in ones; see palpate "
            "calibrate-device show");
    return end;
}

outcome session_configure(session *s) {
    palp_wire_message gains = {.type = PALP_WIRE_TYPE_SELECT_GAINS,
                               .as.select_gains = {.softness = (uint8_t)s->options->gains}};
    outcome end = session_stream(s, true);
    end = end ? end : set_limits(s);
    end = end ? end : set_calibration(s);
    end = end ? end : set_trigger(s);
    end = end ? end : read_calibration(s);
    return end ? end : session_order(s, &gains, "take the gains");
}

outcome session_home(session *s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_HOME};
    snprintf(s->doing, sizeof s->doing, "homing");
    outcome end = session_order(s, &m, "home");
    end = end ? end : session_settle(s, 60);
    return end || s->device.status.homed ? end : session_fail(s, "the plate did not reach home");
}

static outcome read_axis(session *s, uint8_t axis, double row_N[PALP_WIRE_CHANNELS]) {
    palp_wire_message ask = {.type = PALP_WIRE_TYPE_GET_CALIBRATION, .as.get_calibration = {.axis = axis}},
                      got = {0};
    outcome end = session_ask(s, &ask, &got);
    for (size_t c = 0; c < PALP_WIRE_CHANNELS && end == GOES_ON; c++) {
        row_N[c] = 1e-9 * got.as.calibration.row[c];
        s->scale.tare[c] = got.as.calibration.tare[c] / 16.0;
    }
    return end;
}

/* Reads the factors from counts to newtons. */
outcome session_read_scale(session *s) {
    outcome end = read_axis(s, DEVICE_AXIS_Z, s->scale.row_N);
    const bool all = (s->options->columns & ACQUIRE_FORCES) != 0;
    for (uint8_t axis = 0; all && axis < PALP_WIRE_CHANNELS && end == GOES_ON; axis++)
        end = read_axis(s, axis, s->scale.matrix[axis]);
    return end;
}

/* Tares in air; then only contact is missing in the conversion of counts. */
outcome session_tare(session *s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_TARE, .as.tare = {.samples = TARE_TICKS}};
    snprintf(s->doing, sizeof s->doing, "taring");
    outcome end = session_order(s, &m, "tare");
    end = end ? end : session_wait(s, TARE_TICKS * s->scale.tick_s + 0.1);
    return end ? end : session_read_scale(s);
}

/* Why no contact was found, as the device reports. */
static outcome say_no_contact(session *s, double travel_mm) {
    switch (s->device.status.search) {
    case PALP_WIRE_SEARCH_NO_AIR:
        return session_fail(
            s,
            "contact: the force reached %g N at once; is the plate already in the specimen, or "
            "--contact-N within the sensor's noise?",
            s->options->contact_N);
    case PALP_WIRE_SEARCH_NO_SLOPE:
        return session_fail(s,
                            "contact: the force reached %g N, but its rise with depth is hidden by noise: "
                            "the specimen is too soft for this sensor, or the sensor drifts",
                            s->options->contact_N);
    default:
        return session_fail(s, "no contact within %g mm of travel; is a specimen under the plate?",
                            travel_mm);
    }
}

outcome session_find_contact(session *s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_FIND_CONTACT};
    double travel_mm = 1e-6 * s->limits.travel_nm;
    m.as.find_contact.rate_nm_s = (uint32_t)lrint(1e6 * SEEK_MM_S);
    m.as.find_contact.force_uN = (int32_t)lrint(1e6 * s->options->contact_N);
    m.as.find_contact.travel_nm = s->limits.travel_nm;
    snprintf(s->doing, sizeof s->doing, "finding contact");
    outcome end = session_order(s, &m, "find contact");
    end = end ? end : session_settle(s, travel_mm / SEEK_MM_S + 60);
    if (end == GOES_ON && !s->device.status.contact_known)
        return say_no_contact(s, travel_mm);
    return end;
}

/* Checks a run before the session starts, as the device does when its turn comes. */
outcome session_check_run(session *s, const acquire_run *r) {
    double above_mm = s->scale.count_mm * s->scale.contact, below_mm = 1e-6 * s->limits.travel_nm - above_mm;
    outcome end = session_segments(s, r);
    if (end == GOES_ON && r->deepest_mm > below_mm)
        end =
            session_fail(s, "%s goes to a depth of %g mm, but the plate's travel ends %.2f mm below contact",
                         r->name, r->deepest_mm, below_mm);
    else if (end == GOES_ON && r->highest_mm < -above_mm)
        end = session_fail(s, "%s begins %g mm above contact, but home is only %.2f mm above it", r->name,
                           -r->highest_mm, above_mm);
    return end;
}

static void say_contact(session *s) {
    const palp_wire_status *now = &s->device.status;
    acquire_live_end(&s->live);
    session_tell(s, false, "contact %.3f mm below home, %.4g N/m, gains of class %u",
                 s->scale.count_mm * s->scale.contact, 1e-3 * now->stiffness_mN_m, (unsigned)now->softness);
}

/* An interrupted session may have left the device in a run. */
outcome session_end_last(session *s) {
    palp_wire_message m = {.type = PALP_WIRE_TYPE_STOP};
    outcome end = session_status(s);
    if (end || !session_moving(s))
        return end;
    session_tell(s, true, "the device is still in a run of an earlier session; it withdraws first");
    end = session_order(s, &m, "stop");
    return end ? end : session_settle(s, 30);
}

outcome session_make_ready(session *s) {
    bool keep = s->options->keep_contact;
    outcome end = session_end_last(s);
    end = end ? end : session_configure(s);
    if (end == GOES_ON && keep && !s->device.status.contact_known)
        end = session_fail(s, "the device knows no contact; leave out --keep-contact");
    end = end || keep ? end : session_home(s);
    end = end ? end : session_tare(s);
    end = end || keep ? end : session_find_contact(s);
    end = end ? end : session_status(s);
    if (end)
        return end;
    s->scale.contact = s->device.status.contact;
    say_contact(s);
    for (size_t i = 0; i < s->plan->n && end == GOES_ON; i++)
        end = session_check_run(s, &s->plan->run[i]);
    return end;
}
