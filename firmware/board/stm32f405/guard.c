/* guard.c: closes address 0, where the chip shows its flash a second time. Access through a null pointer then
 * is a fault, which restarts with the motor off. */
#include "drivers.h"

/* PM0214, 4.2: a region of 2^(SIZE + 1) bytes, here the whole second view, without any access. */
enum { REGION_1_MIB = 19 << 1 };

void guard_start(void) {
    MPU->RNR = 0;
    MPU->RBAR = 0;
    MPU->RASR = MPU_RASR_XN | REGION_1_MIB | MPU_RASR_ENABLE;
    MPU->CTRL = MPU_CTRL_PRIVDEFENA | MPU_CTRL_ENABLE; /* all other memory as without it */
    BARRIER();
}
