/* fuzz_calibration.c: libFuzzer's harness for calibrations of the force sensor; run.sh builds and runs it. */
#include "fuzz.h"

#include "acquire/acquire.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    int32_t row[PALP_WIRE_CHANNELS][PALP_WIRE_CHANNELS];
    bool given[PALP_WIRE_CHANNELS] = {false};
    acquire_calibration_read(fuzz_file(path, ".json", data, size), row, given);
    return 0;
}
