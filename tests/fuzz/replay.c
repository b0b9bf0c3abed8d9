/* replay.c: runs a harness once on each file that is named, where the compiler has no libFuzzer. */
#include "fuzz.h"

static int replay(const char *path) {
    FILE *from = fopen(path, "rb");
    long size = from && fseek(from, 0, SEEK_END) == 0 ? ftell(from) : -1;
    uint8_t *data = size >= 0 ? malloc(size > 0 ? (size_t)size : 1) : NULL;
    int bad = !data || fseek(from, 0, SEEK_SET) != 0 || fread(data, 1, (size_t)size, from) != (size_t)size;
    if (from)
        fclose(from);
    printf("%s\n", path);
    fflush(stdout);
    if (!bad)
        LLVMFuzzerTestOneInput(data, (size_t)size);
    free(data);
    return bad;
}

int main(int argc, char **argv) {
    for (int i = 1; i < argc; i++)
        if (replay(argv[i]) != 0)
            return 1;
    printf("%d files\n", argc - 1);
    return argc < 2;
}
