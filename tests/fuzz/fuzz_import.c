/* fuzz_import.c: libFuzzer's harness for other testers' recordings; run.sh builds and runs it. */
#include "fuzz.h"

#include "import/import.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    import_options o = {.format = -1,
                        .protocol = -1,
                        .separator = -1,
                        .skip_lines = SIZE_MAX,
                        .height_mm = 1,
                        .radius_mm = 1,
                        .from_s = NAN,
                        .to_s = NAN};
    import_sources all = {0};
    int code = import_read(&o, fuzz_file(path, ".txt", data, size), &all);
    for (size_t i = 0; code == 0 && i < all.n; i++) {
        code = import_columns(&o, all.source[i]);
        code = code || all.source[i]->skip ? code : import_signs(&o, all.source[i]);
        code = code || all.source[i]->skip ? code : import_contact_rule(&o, all.source[i]);
        code = code || all.source[i]->skip ? code : import_contact_find(&o, &all, all.source[i]);
    }
    import_free(&all);
    return 0;
}
