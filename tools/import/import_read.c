/* import_read.c: which format a file has, and its tables. */
#include "import.h"

#include <string.h>

static const char NAME[] = "import";

/* Whether the first lines of the text hold a word. */
static bool near_the_top(const import_text *text, const char *word) {
    enum { HEADER_LINES = 12 };
    for (size_t i = 0; i < text->n && i < HEADER_LINES; i++)
        if (strstr(text->lines[i], word))
            return true;
    return false;
}

static import_format detect(const import_text *text) {
    if (import_mach1_starts(text))
        return IMPORT_MACH1;
    bool instron = near_the_top(text, "INSTRON") || near_the_top(text, "Instron");
    return instron && near_the_top(text, "Cylinder") ? IMPORT_INSTRON : IMPORT_CSV;
}

int import_read(const import_options *o, const char *file, import_sources *all) {
    import_text text;
    int code = import_text_read(file, &text);
    if ((code || text.n == 0) && import_left_out(o, file)) {
        import_text_free(&text);
        return CLI_OK;
    }
    if (code == CLI_OK && text.n == 0) {
        code = cli_failure(NAME, "%s: the file is empty", file);
    } else if (code == CLI_OK && near_the_top(&text, "# palpate.experiment")) {
        code = cli_failure(NAME, "%s: is already an experiment of palpate", file);
    } else if (code == CLI_OK) {
        size_t first = all->n;
        import_format format = o->format >= 0 ? (import_format)o->format : detect(&text);
        code =
            format == IMPORT_MACH1 ? import_mach1_read(&text, all) : import_table_read(o, &text, format, all);
        for (size_t i = first; i < all->n; i++) {
            import_specimen(o, all->source[i]);
            import_tip(o, all->source[i]);
            code = code || format == IMPORT_MACH1 ? code : import_rate(o, all->source[i]);
        }
        code = code || format == IMPORT_MACH1 ? code : import_join(o, all, first);
    }
    import_text_free(&text);
    return code;
}
