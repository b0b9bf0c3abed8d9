/* board.c: the firmware's view of the STM32F405 under QEMU. Tick, startup, watchdog and reset are those of
 * the real board. Sensors, motor and the line to the host are the plant at the other end of two FIFOs: QEMU
 * makes a dozen system calls for each byte that its UART sends. Run it by qemu-system-arm -M
 * netduinoplus2 -kernel rig.elf -display none -monitor none -serial none -icount shift=3,sleep=off
 * -semihosting-config enable=on,target=native,arg=PLANT_TO_FIRMWARE,arg=FIRMWARE_TO_PLANT,arg=FLASH. The
 * FIFOs must exist before, without a space in their names; the plant opens them in the same order. FLASH, a
 * file that keeps the parameters, may be left out. The exit code is 0 after PLANT_EVENT_QUIT, 1 when the
 * plant has gone. Costs are right for shift=3. */
#include "drivers.h"
#include "semihosting.h"
#include "simulated.h"

enum { NS_AN_INSTRUCTION = 8 }; /* shift=3 */

static struct {
    uint8_t cause;
    uint32_t last_ns;
    uint64_t ns;
} rig;

uint8_t hal_init(void) {
    gpio_start();
    (void)clock_start(); /* run for the code's sake: QEMU has no RCC and is always at full speed */
    rig.cause = reset_cause();
    TIM2->CR1 = TIM_CR1_CEN;
    semihosting_open();
    const uint8_t cause = simulated_boot();
    if (cause != APP_RESET_POWER)
        rig.cause = cause;
    watchdog_start();
    tick_start(CLOCK_FULL_HZ);
    return 0;
}

uint8_t hal_reset_cause(void) {
    return rig.cause;
}

const char *hal_board_name(void) {
    return "rig";
}

void board_tick(void) {
    simulated_tick(tick_spent(), (uint16_t)stack_free());
}

/* What PLANT_EVENT_LATE asks for. */
static void miss_a_tick(void) {
    const uint32_t from = tick_now();
    while (tick_now() - from < 2)
        ;
}

void hal_drive(const app_outputs *outputs) {
    tick_renew();
    simulated_drive(outputs);
    if (simulated_late())
        miss_a_tick();
}

void motor_brake(void) {
    simulated_drive(&(app_outputs){0});
}

void motor_off(void) {
    motor_brake(); /* only ever just before a reset, which opens it */
}

/* There is none to watch. */
void supply_interrupt(void) {
}

/* QEMU's TIM2 counts nanoseconds of virtual time, in proportion to instructions. It must be read every 4 s.
 */
uint32_t board_cycles(void) {
    const uint32_t now = TIM2->CNT;
    rig.ns += now - rig.last_ns;
    rig.last_ns = now;
    return (uint32_t)(rig.ns / NS_AN_INSTRUCTION);
}
