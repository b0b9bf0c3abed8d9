/* fuzz_report.c: libFuzzer's harness for the files of a report, a NUL between them, as far as what its page
 * shows; run.sh builds and runs it. */
#include "fuzz.h"

#include "report/report.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    enum { FILES = 4 };
    char path[256], ending[16];
    report r = {.file = calloc(FILES, sizeof *r.file)};
    const uint8_t *end = data + size;
    int code = r.file == NULL;
    for (size_t i = 0; code == 0 && i < FILES && data < end; i++) {
        const uint8_t *nul = memchr(data, 0, (size_t)(end - data)), *stop = nul ? nul : end;
        snprintf(ending, sizeof ending, "%zu.%s", i, *data == '{' ? "json" : "csv");
        code = report_add(&r, fuzz_file(path, ending, data, (size_t)(stop - data)), false);
        data = stop + (nul != NULL);
    }
    report_sort(&r);
    if (code == 0 && report_pairs(&r) == 0)
        json_decref(report_json(&r, "fuzz"));
    report_free(&r);
    return 0;
}
