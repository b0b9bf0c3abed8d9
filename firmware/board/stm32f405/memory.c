/* memory.c: the functions that a compiler calls by itself, so that no C library is needed. */
#include <stdint.h>
#include <string.h>

/* Words first, wherever they lie: the Cortex-M4 reads and writes them at any address. */
void *memset(void *to, int value, size_t n) {
    unsigned char *byte = to;
    const uint32_t word = (unsigned char)value * 0x01010101u;
    for (; n >= sizeof word; n -= sizeof word, byte += sizeof word)
        __builtin_memcpy(byte, &word, sizeof word);
    for (; n > 0; n--)
        *byte++ = (unsigned char)value;
    return to;
}

void *memcpy(void *restrict to, const void *restrict from, size_t n) {
    unsigned char *t = to;
    const unsigned char *f = from;
    for (; n >= sizeof(uint32_t); n -= sizeof(uint32_t), t += sizeof(uint32_t), f += sizeof(uint32_t))
        __builtin_memcpy(t, f, sizeof(uint32_t));
    for (; n > 0; n--)
        *t++ = *f++;
    return to;
}

int memcmp(const void *one, const void *other, size_t n) {
    const unsigned char *a = one, *b = other;
    for (; n > 0 && *a == *b; n--, a++, b++)
        ;
    return n > 0 ? *a - *b : 0;
}
