/* fuzz_report.c: libFuzzer's harness for results on a report's page; run.sh builds and runs it. */
#include "fuzz.h"

#include "report/report.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    static report r;
    static report_file file[REPORT_FILES_MAX];
    r = (report){.file = file};
    if (report_add(&r, fuzz_file(path, ".json", data, size), false) == 0)
        json_decref(report_json(&r, "fuzz"));
    for (size_t i = 0; i < r.n; i++) {
        json_decref(file[i].json);
        free(file[i].path);
    }
    return 0;
}
