/* sensor_cell.h: an amplifier of one load cell. */
#ifndef SENSOR_CELL_H
#define SENSOR_CELL_H

#include "../stm32f405/drivers.h"

bool cell_start(void);
bool cell_there(void);   /* it has a sample that was not taken yet */
int32_t cell_take(void); /* that one: counts of the machine's count_nN, and beyond 16 bits */

#endif
