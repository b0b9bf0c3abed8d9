/* page.c: the one page of results, of the bytes of page.html, page.css and page.js in tools/page, which make
 * puts into page_bytes.h. */
#include "page.h"

#include "cli.h"
#include "json_out.h"
#include "page_bytes.h"

/* Nothing in the JSON ends its element or begins another: what HTML gives a meaning is escaped. */
static int put_escaped(const char *text, size_t n, void *to) {
    for (size_t i = 0; i < n; i++)
        if (text[i] == '<' || text[i] == '>' || text[i] == '&')
            fprintf(to, "\\u%04x", (unsigned)text[i]);
        else
            fputc(text[i], to);
    return 0;
}

int page_save(const char *name, json_t *result, const char *path) {
    const size_t look = JSON_COMPACT | JSON_PRESERVE_ORDER | JSON_ENSURE_ASCII | JSON_REAL_PRECISION(15);
    palp_file page;
    int code = result ? cli_file_open(name, path, &page) : cli_failure(name, "out of memory");
    if (code == CLI_OK) {
        FILE *to = page.stream;
        fwrite(page_html, 1, sizeof page_html, to);
        fputs("<style>\n", to);
        fwrite(page_css, 1, sizeof page_css, to);
        fputs("</style>\n<script type=\"application/json\" id=\"result\">\n", to);
        bool whole = json_dump_callback(result, put_escaped, to, look) == 0;
        fputs("\n</script>\n<script>\n", to);
        fwrite(page_js, 1, sizeof page_js, to);
        fputs("</script>\n", to);
        if (!whole) {
            palp_file_abandon(&page);
            code = cli_failure(name, "out of memory");
        } else {
            code = cli_file_close(name, &page);
        }
    }
    json_decref(result);
    return code;
}

int page_result(const char *name, json_t *result, json_t *figures, bool json, const char *result_path,
                const char *report_path) {
    int code = json ? json_print(name, json_incref(result)) : CLI_OK;
    json_object_set_new(result, "figures", figures ? figures : json_array());
    if (code == CLI_OK && result_path)
        code = json_save(name, json_incref(result), result_path);
    if (code == CLI_OK && report_path)
        code = page_save(name, json_incref(result), report_path);
    json_decref(result);
    return code;
}
