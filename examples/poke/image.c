/* image.c: a picture as PNG or BMP. */
#include "poke.h"

#include <stb_image_write.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool image_write(const char *path, int width, int height, const unsigned char *rgb) {
    size_t length = strlen(path);
    char *part = malloc(length + 6);
    if (!part) {
        fprintf(stderr, "poke: out of memory\n");
        return false;
    }
    sprintf(part, "%s.part", path);
    bool bmp = length > 4 && strcmp(path + length - 4, ".bmp") == 0;
    stbi_flip_vertically_on_write(1);
    bool ok = bmp ? stbi_write_bmp(part, width, height, 3, rgb)
                  : stbi_write_png(part, width, height, 3, rgb, 3 * width);
    ok = ok && rename(part, path) == 0;
    if (!ok) {
        fprintf(stderr, "poke: %s: cannot be written\n", path);
        remove(part);
    }
    free(part);
    return ok;
}
