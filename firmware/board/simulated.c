/* simulated.c: the firmware's view of a board in the simulated plant. */
#include "simulated.h"

enum { RECEIVE = 512 };

static struct {
    plant_in in;
    plant_out out;
    bool late;
    uint8_t byte[RECEIVE];
    ring received, *transmit;
    uint32_t stored[STORE_WORDS];
} simulated;

static void write_record(void) {
    uint8_t out[PLANT_LINK_OUT];
    simulated.out.tick = simulated.in.tick;
    simulated.out.version = PLANT_LINK_VERSION;
    plant_link_put_out(&simulated.out, out);
    simulated_write(out);
    simulated.out.tx_count = 0;
}

static void take_bytes(void) {
    simulated.out.tx_count = (uint8_t)ring_take(simulated.transmit, simulated.out.tx, PLANT_LINK_TX);
}

/* Sends the bytes that wait first. */
static void quit(void) {
    while (simulated.transmit != NULL && ring_used(simulated.transmit) > 0) {
        take_bytes();
        write_record();
    }
    write_record();
    simulated_end();
}

static void do_events(uint8_t events) {
    if ((events & PLANT_EVENT_QUIT) != 0)
        quit();
    if ((events & (PLANT_EVENT_HANG | PLANT_EVENT_BROWN_OUT)) != 0)
        simulated_restart();
    if ((events & PLANT_EVENT_SMASH) != 0)
        simulated_smash();
    if ((events & PLANT_EVENT_LATE) != 0)
        simulated.late = true;
}

static void exchange(void) {
    uint8_t in[PLANT_LINK_IN];
    write_record();
    simulated_read(in);
    plant_link_get_in(in, &simulated.in);
    for (int i = 0; i < simulated.in.rx_count && i < PLANT_LINK_RX; i++)
        (void)ring_put(
            &simulated.received,
            simulated.in.rx[i]); /* bytes that do not fit are lost; their frame then fails its check */
    do_events(simulated.in.events);
}

/* The flash of the parameters, as it was left. */
static void open_store(void) {
    uint32_t *words = simulated.stored;
    for (uint32_t i = 0; i < STORE_WORDS; i++)
        words[i] = STORE_BLANK;
    simulated_recall(words, STORE_WORDS);
    const uint32_t erase = store_to_erase(words) * STORE_AREA;
    for (uint32_t i = 0; erase < STORE_WORDS && i < STORE_AREA; i++)
        words[erase + i] = STORE_BLANK;
    if (erase < STORE_WORDS)
        simulated_keep(erase, words + erase, STORE_AREA);
}

const uint32_t *hal_stored(void) {
    return simulated.stored;
}

void hal_store(uint32_t at, uint32_t word) {
    simulated.stored[at] &= word;
    simulated_keep(at, simulated.stored + at, 1);
}

uint8_t simulated_boot(void) {
    open_store();
    ring_init(&simulated.received, simulated.byte, RECEIVE);
    simulated.out.boot = 1;
    exchange();
    simulated.out.boot = 0;
    return simulated.in.reset_cause;
}

void simulated_tick(uint32_t last_cost, uint16_t stack_free) {
    simulated.out.cost = last_cost;
    simulated.out.stack_free = stack_free;
    exchange();
}

void simulated_drive(const app_outputs *outputs) {
    simulated.out.duty = outputs->motor_on ? outputs->duty : 0;
    simulated.out.trigger = outputs->trigger;
    simulated.out.place = outputs->place;
    simulated.out.motor = outputs->motor_on ? PLANT_MOTOR_ON : PLANT_MOTOR_BRAKED;
}

bool simulated_late(void) {
    const bool late = simulated.late;
    simulated.late = false;
    return late;
}

uint32_t hal_cost(void) {
    return 0;
}

uint32_t hal_stack_free(void) {
    return 0;
}

const machine *hal_machine(void) {
    return simulated.in.machine == PLANT_STEPPER        ? &machine_stepper
           : simulated.in.machine == PLANT_STEPPER_FAST ? &machine_stepper_fast
                                                        : &machine_indenter;
}

bool hal_is_simulated(void) {
    return true;
}

uint32_t hal_serial_number(void) {
    return 1;
}

void hal_sense(app_inputs *inputs) {
    const plant_in *in = &simulated.in;
    inputs->position = in->position;
    for (int i = 0; i < PALP_WIRE_CHANNELS; i++)
        inputs->adc[i] = in->adc[i];
    inputs->thermistor = in->thermistor;
    inputs->sensor_silent = (in->switches & PLANT_SENSOR_SILENT) != 0;
    inputs->home_switch = (in->switches & PLANT_SWITCH_HOME) != 0;
    inputs->emergency_stop = (in->switches & PLANT_SWITCH_EMERGENCY) != 0;
    inputs->encoder_lost = (in->switches & PLANT_ENCODER_LOST) != 0;
    inputs->driver_fault = (in->switches & PLANT_DRIVER_FAULT) != 0;
    inputs->force_held = (in->switches & PLANT_FORCE_HELD) != 0;
    inputs->trigger = (in->switches & PLANT_TRIGGER) != 0;
}

bool hal_receive(uint8_t *byte) {
    if ((simulated.in.events & PLANT_EVENT_DEAF) == 0)
        return ring_get(&simulated.received, byte);
    while (ring_get(&simulated.received, byte))
        ;
    return false;
}

void hal_transmit(ring *transmit) {
    simulated.transmit = transmit;
    if ((simulated.in.events & PLANT_EVENT_STALL_TX) == 0)
        take_bytes();
}
