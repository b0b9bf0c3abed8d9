/* sensor_cell.h: an amplifier of one load cell. */
#ifndef SENSOR_CELL_H
#define SENSOR_CELL_H

#include "../stm32f405/drivers.h"

bool cell_start(void);
bool cell_there(void);   /* there is a sample that was not taken yet */
int32_t cell_take(void); /* takes it: counts of the machine's count_nN; may exceed 16 bits */

#endif
