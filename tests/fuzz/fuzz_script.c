/* fuzz_script.c: libFuzzer's harness for scripts of the virtual indenter; run.sh builds and runs it. */
#include "fuzz.h"

#include "rig/rig_internal.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    const rig_settings settings = {.script = fuzz_file(path, ".txt", data, size)};
    rig_feed feed;
    rig_feed_open("rig", &settings, &feed);
    rig_feed_free(&feed);
    return 0;
}
