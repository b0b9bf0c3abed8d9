/* fuzz_experiment.c: libFuzzer's harness for experiments, and what makes recordings of them; run.sh builds
 * and runs it. */
#include "fuzz.h"

#include <palpate/recording.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    palp_experiment *run;
    palp_recording recording;
    const palp_recording_settings settings = palp_recording_settings_default();
    if (palp_experiment_read(fuzz_file(path, ".csv", data, size), &run, NULL) == PALP_OK) {
        if (palp_recording_prepare(run, "run.csv", &settings, &recording, NULL) == PALP_OK) {
            palp_recording_free(&recording);
        }
        palp_experiment_free(run);
    }
    return 0;
}
