/* fuzz_reduced.c: libFuzzer's harness for reduced models: the JSON, a NUL, the arrays; run.sh builds and runs
 * it. */
#include "fuzz.h"

#include <palpate/reduce.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    const uint8_t *nul = memchr(data, 0, size);
    size_t text = nul ? (size_t)(nul - data) : size;
    char arrays[256];
    palp_model model;
    palp_reduced *reduced;
    fuzz_file(arrays, ".bin", data + text + (nul != NULL), size - text - (nul != NULL));
    if (palp_reduced_read(fuzz_file(path, ".json", data, text), &model, NULL, &reduced, NULL) == PALP_OK) {
        palp_reduced_free(reduced);
    }
    return 0;
}
