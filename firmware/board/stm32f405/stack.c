/* stack.c: the stack, at the bottom of the memory, so that overrunning it destroys nothing. It is painted at
 * the start; its lowest words are the guard. */
#include "drivers.h"

enum { PAINT = 0x57ac57ac, GUARD_WORDS = 8, LOOKS = 8 };

#ifndef STACK_BOTTOM
extern uint32_t stack_bottom[], stack_top[]; /* stm32f405.ld */
#define STACK_BOTTOM stack_bottom
#define STACK_TOP stack_top
#define STACK_NOW ((uint32_t *)__builtin_frame_address(0) - 16) /* and what this function itself uses */
#endif

void stack_paint(void) {
    for (uint32_t *word = STACK_BOTTOM; word < STACK_NOW; word++)
        *(volatile uint32_t *)word = PAINT;
}

bool stack_overran(uintptr_t pointer) {
    return pointer < (uintptr_t)(STACK_BOTTOM + GUARD_WORDS);
}

bool hal_stack_intact(void) {
    bool intact = true;
    for (int i = 0; i < GUARD_WORDS; i++) {
        if (STACK_BOTTOM[i] != PAINT)
            intact = false;
        STACK_BOTTOM[i] = PAINT;
    }
    return intact;
}

/* A few words a call: what a deeper call has used shows within some hundred of them. */
uint32_t stack_free(void) {
    static uint32_t *lowest, *look; /* lowest word known to have been used; where the search is */
    if (lowest == NULL) {
        lowest = STACK_TOP;
        look = STACK_BOTTOM;
    }
    for (int i = 0; i < LOOKS; i++) {
        if (look == lowest) {
            look = STACK_BOTTOM;
        } else if (*look != PAINT) {
            lowest = look;
            look = STACK_BOTTOM;
        } else {
            look++;
        }
    }
    return (uint32_t)(lowest - STACK_BOTTOM) * 4;
}
