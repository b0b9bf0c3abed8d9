/* fuzz_model.c: libFuzzer's harness for model files, whose copy must be a model too; run.sh builds and runs
 * it. */
#include "fuzz.h"

#include <palpate/model.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    char copy[256];
    palp_model model;
    palp_mesh_source source;
    if (palp_model_read(fuzz_file(path, ".json", data, size), &model, &source, NULL) == PALP_OK &&
        palp_model_write(&model, fuzz_file(copy, ".copy.json", data, 0), NULL) == PALP_OK &&
        palp_model_read(copy, &model, &source, NULL) != PALP_OK) {
        abort();
    }
    return 0;
}
