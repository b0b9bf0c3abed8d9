/* fuzz_protocol.c: libFuzzer's harness for protocols of acquire; run.sh builds and runs it. */
#include "fuzz.h"

#include "acquire/acquire.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    static acquire_plan plan;
    const acquire_motion options = acquire_motion_none();
    memset(&plan, 0, sizeof plan);
    if (acquire_plan_read(&plan, fuzz_file(path, ".json", data, size), &options) == 0) {
        acquire_plan_arrange(&plan);
    }
    return 0;
}
