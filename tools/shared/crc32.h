/* crc32.h: CRC-32 of ISO 3309, as zip and cksum -a crc32b give it. */
#ifndef PALPATE_CRC32_H
#define PALPATE_CRC32_H

#include <stddef.h>
#include <stdint.h>

/* CRC-32 of n more bytes after those of crc; 0 to begin with. */
uint32_t crc32_add(uint32_t crc, const void *bytes, size_t n);

#endif
