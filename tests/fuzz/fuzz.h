/* fuzz.h: what the harnesses of the readers share: the input as a file in TMPDIR. */
#ifndef FUZZ_H
#define FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Its path, valid until the next call with this ending. */
static inline const char *fuzz_file(char path[256], const char *ending, const uint8_t *data, size_t size) {
    const char *folder = getenv("TMPDIR");
    snprintf(path, 256, "%s/input%s", folder ? folder : "/tmp", ending);
    FILE *to = fopen(path, "wb");
    if (!to || fwrite(data, 1, size, to) != size || fclose(to) != 0) {
        abort();
    }
    return path;
}

#endif
