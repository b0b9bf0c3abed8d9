/* closed_loop.c: the control of the plate around the simulated indenter, in process, without the app. */
#include "closed_loop.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

const double softness_scale[SOFTNESSES] = {0.2, 0.45, 1, 2, 3.2, 5};
const double softness_border[SOFTNESSES + 1] = {0.14, 0.3, 0.6708, 1.4142, 2.5298, 4, 6.25};

static const machine *const m = &machine_indenter;

void loop_open(loop *l, plant_settings settings) {
    palp_error error;
    settings.actuator.start_m = settings.contact_m - (double)LOOP_AIR_M;
    *l = (loop){.gains = &gains_table[GAINS_MIDDLE], .start_m = settings.actuator.start_m};
    if (plant_create(&settings, &l->plant, &error))
        fail_msg("%s", error.text);
    plant_first(l->plant, &l->in);
    force_init(&l->force);
    pid_reset(&l->pid);
}

void loop_close(loop *l) {
    plant_free(l->plant);
}

double loop_force(const loop *l) {
    return (double)force_axis(&l->force, l->in.adc, FORCE_Z);
}

double loop_position(const loop *l) {
    return plant_look(l->plant).carriage_m - l->start_m;
}

void loop_tick(loop *l, const reference *to) {
    float position = (float)l->in.position * m->count_m,
          depth = l->known ? to->position_m - l->contact_m : 0.0f;
    float force = pid_step(&l->pid, l->gains, l->gains->feed_N_m, to, position, depth, m->moving_kg,
                           m->motor_drag_Ns_m, m->friction_N, m->current_A * m->force_constant_N_A);
    plant_out out = {.duty = (int16_t)lrintf(force / m->motor_N * 32767.0f), .motor = PLANT_MOTOR_ON};
    palp_error error;
    if (plant_step(l->plant, &out, &l->in, &error))
        fail_msg("%s", error.text);
}

void loop_rest(loop *l, float at_m, int ticks) {
    const reference at = {.position_m = at_m};
    while (ticks-- > 0)
        loop_tick(l, &at);
}

void loop_go(loop *l, float from_m, float to_m) {
    stroke way;
    reference next;
    stroke_begin(&way, from_m, to_m, 5e-3f, 0.5f);
    while (stroke_step(&way, &next))
        loop_tick(l, &next);
}

contact loop_search(loop *l, float rate_m_s, float end_m) {
    stroke way;
    reference next = {.position_m = 0};
    contact c;
    contact_begin(&c, 0.01f, end_m);
    stroke_begin(&way, 0, end_m + 1e-3f, rate_m_s, 0.5f);
    while (c.phase < CONTACT_FOUND && stroke_step(&way, &next)) {
        contact_step(&c, (float)l->in.position * m->count_m, (float)loop_force(l));
        loop_tick(l, &next);
    }
    return c;
}
