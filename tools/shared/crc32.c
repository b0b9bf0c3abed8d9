/* crc32.c: see crc32.h. */
#include "crc32.h"

uint32_t crc32_add(uint32_t crc, const void *bytes, size_t n) {
    const unsigned char *at = bytes;
    uint32_t table[256];
    for (uint32_t i = 0; i < 256; i++) {
        table[i] = i;
        for (int k = 0; k < 8; k++)
            table[i] = table[i] & 1 ? (table[i] >> 1) ^ UINT32_C(0xedb88320) : table[i] >> 1;
    }
    crc = ~crc;
    for (size_t i = 0; i < n; i++)
        crc = (crc >> 8) ^ table[(crc ^ at[i]) & 0xff];
    return ~crc;
}
