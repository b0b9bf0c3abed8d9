/* gains.c: gains for six classes of softness, as "test_tracking tune" finds them; see doc/control.md. */
#include "pid.h"

const gains gains_table[GAINS_CLASSES] = {
    {143.0f, 5780.0f, 137200.0f, 44.0f, 150.0f, 100.0f},
    {320.0f, 5655.0f, 137200.0f, 44.0f, 150.0f, 225.0f},
    {675.0f, 8170.0f, 245650.0f, 62.0f, 150.0f, 500.0f},
    {1207.0f, 9830.0f, 342950.0f, 74.0f, 150.0f, 1000.0f},
    {1908.0f, 10400.0f, 400000.0f, 80.0f, 150.0f, 1600.0f},
    {1e6f, 12020.0f, 532400.0f, 92.0f, 150.0f, 2500.0f},
};

uint8_t gains_class(const gains table[GAINS_CLASSES], float stiffness_N_m) {
    uint8_t k = 0;
    while (k < GAINS_CLASSES - 1 && stiffness_N_m > table[k].stiffness_N_m)
        k++;
    return k;
}
