/* fuzz_report.c: libFuzzer's harness for results on a report's page; run.sh builds and runs it. */
#include "fuzz.h"

#include "report/report.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    report r = {.file = calloc(REPORT_FILES_MAX, sizeof(report_file))};
    if (r.file && report_add(&r, fuzz_file(path, ".json", data, size), false) == 0)
        json_decref(report_json(&r, "fuzz"));
    report_free(&r);
    return 0;
}
