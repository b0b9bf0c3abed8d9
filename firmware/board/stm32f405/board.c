/* board.c: the firmware's view of the real board. */
#include "drivers.h"

static struct {
    uint8_t cause;
    volatile int32_t position; /* at the tick */
} board;

static void cycle_counter_start(void) {
    *DEMCR |= DEMCR_TRCENA;
    DWT->CTRL |= DWT_CTRL_CYCCNTENA;
}

uint8_t hal_init(void) {
    uint8_t failed = 0;
    gpio_start();
    const clock_state clock = clock_start();
    motor_start(clock.hz);
    supply_start();
    flash_start();
    switches_start();
    board.cause = reset_cause();
    if (!clock.crystal)
        failed |= APP_CLOCK_FAILED;
    if (!gauge_start())
        failed |= APP_SENSOR_FAILED;
    if (!encoder_start())
        failed |= APP_ENCODER_FAILED;
    thermistor_start();
    trigger_start();
    uart_start(clock.bus_hz);
    cycle_counter_start();
    watchdog_start();
    tick_start(clock.hz);
    return failed;
}

uint8_t hal_reset_cause(void) {
    return board.cause;
}

uint32_t hal_serial_number(void) {
    return UNIQUE_ID[0] ^ UNIQUE_ID[1] ^ UNIQUE_ID[2];
}

bool hal_is_simulated(void) {
    return false;
}

void board_tick(void) {
    gauge_convert();
    board.position = encoder_read();
}

void hal_sense(app_inputs *inputs) {
    inputs->position = board.position;
    inputs->sensor_silent = !gauge_read(inputs->adc, &inputs->force_held);
    inputs->thermistor = thermistor_read();
    inputs->home_switch = switches_home();
    inputs->emergency_stop = motor_stopped() || switches_emergency();
    inputs->encoder_lost = encoder_lost();
    inputs->driver_fault = motor_fault();
    inputs->trigger = trigger_came();
}

void hal_drive(const app_outputs *outputs) {
    tick_renew();
    trigger_give(outputs->trigger);
    if (outputs->motor_on)
        motor_drive(outputs);
    else
        motor_brake();
}

bool hal_receive(uint8_t *byte) {
    return serial_receive(byte);
}

void hal_transmit(ring *transmit) {
    serial_send(transmit);
}

uint32_t board_cycles(void) {
    return DWT->CYCCNT;
}

uint32_t hal_cost(void) {
    return board_cycles();
}

uint32_t hal_stack_free(void) {
    return stack_free();
}
