/* image.c: a picture as PNG (stored, not compressed: no library is needed) or PPM. */
#include "poke.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A PNG while it is written: the file, the CRC of the present chunk and the Adler sum of the pixels. */
typedef struct png {
    FILE *file;
    uint32_t crc, a, b;
} png;

static void put(png *p, const unsigned char *bytes, size_t n) {
    for (size_t i = 0; i < n; i++) {
        p->crc ^= bytes[i];
        for (int k = 0; k < 8; k++)
            p->crc = p->crc >> 1 ^ (p->crc & 1 ? 0xedb88320u : 0);
    }
    fwrite(bytes, 1, n, p->file);
}

static void put32(png *p, uint32_t v) {
    const unsigned char bytes[4] = {(unsigned char)(v >> 24), (unsigned char)(v >> 16), (unsigned char)(v >> 8),
                                    (unsigned char)v};
    put(p, bytes, 4);
}

static void chunk_begin(png *p, uint32_t size, const char *name) {
    put32(p, size);
    p->crc = 0xffffffffu;
    put(p, (const unsigned char *)name, 4);
}

static void chunk_end(png *p) {
    put32(p, ~p->crc);
}

static void put_pixels(png *p, const unsigned char *bytes, size_t n) {
    for (size_t i = 0; i < n; i++) {
        p->a = (p->a + bytes[i]) % 65521;
        p->b = (p->b + p->a) % 65521;
    }
    put(p, bytes, n);
}

/* Each row is one stored block of the zlib stream: a filter byte, then the pixels. */
static void write_png(FILE *file, int width, int height, const unsigned char *rgb) {
    png p = {file, 0, 1, 0};
    const size_t row = 3 * (size_t)width, block = row + 1;
    const unsigned char none = 0, header[] = {8, 2, 0, 0, 0}, zlib[] = {0x78, 0x01};
    fwrite("\x89PNG\r\n\x1a\n", 1, 8, file);
    chunk_begin(&p, 13, "IHDR");
    put32(&p, (uint32_t)width);
    put32(&p, (uint32_t)height);
    put(&p, header, sizeof header);
    chunk_end(&p);
    chunk_begin(&p, (uint32_t)(2 + (size_t)height * (block + 5) + 4), "IDAT");
    put(&p, zlib, 2);
    for (int y = height - 1; y >= 0; y--) {
        const unsigned char head[5] = {y == 0, (unsigned char)block, (unsigned char)(block >> 8), (unsigned char)~block,
                                       (unsigned char)(~block >> 8)};
        put(&p, head, 5);
        put_pixels(&p, &none, 1);
        put_pixels(&p, rgb + (size_t)y * row, row);
    }
    put32(&p, p.b << 16 | p.a);
    chunk_end(&p);
    chunk_begin(&p, 0, "IEND");
    chunk_end(&p);
}

static void write_ppm(FILE *file, int width, int height, const unsigned char *rgb) {
    fprintf(file, "P6\n%d %d\n255\n", width, height);
    for (int y = height - 1; y >= 0; y--)
        fwrite(rgb + (size_t)y * 3 * (size_t)width, 3, (size_t)width, file);
}

bool image_write(const char *path, int width, int height, const unsigned char *rgb) {
    size_t length = strlen(path);
    char *part = malloc(length + 6);
    if (!part) {
        fprintf(stderr, "poke: out of memory\n");
        return false;
    }
    sprintf(part, "%s.part", path);
    FILE *file = fopen(part, "wb");
    if (file && length > 4 && strcmp(path + length - 4, ".ppm") == 0)
        write_ppm(file, width, height, rgb);
    else if (file)
        write_png(file, width, height, rgb);
    bool ok = file && !ferror(file);
    ok = file && fclose(file) == 0 && ok;
    ok = ok && rename(part, path) == 0;
    if (!ok) {
        fprintf(stderr, "poke: %s: cannot be written\n", path);
        remove(part);
    }
    free(part);
    return ok;
}
