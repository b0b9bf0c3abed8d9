/* fuzz_manifest.c: libFuzzer's harness for the lists of batch and benchmark; run.sh builds and runs it. */
#include "fuzz.h"

#include "batch/batch.h"
#include "benchmark/benchmark.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static benchmark b;
    const char *folder = getenv("TMPDIR");
    char path[256], named[256];
    batch_plan plan = {0};
    if (memchr(data, '/', size)) /* patterns of files in other folders */
        return 0;
    batch_manifest_read(fuzz_file(path, ".json", data, size), &plan);
    batch_plan_free(&plan);
    snprintf(named, sizeof named, "%s/benchmark.json", folder ? folder : "/tmp");
    if (rename(path, named) != 0)
        abort();
    benchmark_read(folder ? folder : "/tmp", &b);
    json_decref(b.root);
    return 0;
}
