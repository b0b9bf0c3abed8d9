/* explain_page.c: what was found, as a page, and as files for palpate report. */
#include "explain.h"
#include "shared/json_out.h"
#include "page.h"

#include <stdlib.h>

static const char NAME[] = "explain";

/* ---- the page ---- */

static void into_page(void *user, const char *name, char *svg) {
    (void)name;
    html_svg(user, svg, PAGE_RESIDUALS);
    free(svg);
}

static int page(FILE *to, const json_t *result, const palp_explanation *e) {
    plot_book book = {.command = NAME, .take = into_page, .user = to};
    html_open(to, "What the model misses");
    page_found(to, result);
    explain_figure(&book, e);
    page_how(to, result);
    fputs("<p class=\"about\"><code>", to);
    html_text(to, json_string_value(json_object_get(result, "command")));
    fputs("</code></p>\n", to);
    html_close(to);
    return plot_close(&book);
}

int explain_page(const explain_options *o, const palp_explanation *e) {
    json_t *result = explain_json(o, e);
    palp_file to;
    int code = result ? cli_file_open(NAME, o->report, &to) : cli_failure(NAME, "out of memory");
    if (code == CLI_OK) {
        code = page(to.stream, result, e);
        if (code)
            palp_file_abandon(&to);
        else
            code = cli_file_close(NAME, &to);
    }
    json_decref(result);
    return code;
}

int explain_plot(const explain_options *o, const palp_explanation *e) {
    plot_book book = {.command = NAME, .folder = o->plot};
    int code = json_save_in(NAME, explain_json(o, e), o->plot, "explain.json");
    if (code == CLI_OK)
        explain_figure(&book, e);
    return code ? code : plot_close(&book);
}
