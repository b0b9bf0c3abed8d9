/* cmd_report.c: palpate report: recordings, models and results on one HTML page. */
#include "report.h"
#include "shared/commands.h"
#include "shared/page.h"

#include <stdlib.h>
#include <string.h>

static const char NAME[] = "report";

typedef struct report_options {
    const char *words[REPORT_FILES_MAX], *out, *title;
    size_t n_words;
} report_options;

static int parse(int argc, char **argv, report_options *o) {
    const cli_option options[] = {
        cli_heading("Output"),
        cli_out("out", "REPORT.html", &o->out, "the page (default: standard output)"),
        cli_text("title", "TEXT", &o->title, "heading of the page (default \"Palpation report\")"),
    };
    const cli_command command = {
        NAME,
        "DIR|FILES ... --out REPORT.html",
        "Puts recordings, fits, parameters with intervals, the stiffness law, results of explain and "
        "calibrate,\n"
        "simulations beside their recordings, and the checksums of all files on one self-contained page.\n"
        "It reads all *.csv and *.json of a folder; characterize, explain and calibrate write results for "
        "it\n"
        "by --result. The file name - means standard input.",
        "  palpate characterize runs/*.csv --out work/lumped.json --result work/characterize.json\n"
        "  palpate explain --model work/lumped.json runs/*.csv --result work/explain.json\n"
        "  palpate report runs work --out report.html\n",
        options,
        sizeof options / sizeof options[0]};
    int code = cli_parse(&command, argc, argv, o->words, REPORT_FILES_MAX, &o->n_words);
    return code == CLI_OK && o->n_words == 0
               ? cli_usage_error(NAME, "name a folder or files; see palpate report --help")
               : code;
}

static int make(const report_options *o, report *r) {
    int code = CLI_OK;
    for (size_t i = 0; i < o->n_words && code == CLI_OK; i++)
        code = report_add(r, o->words[i], true);
    if (code == CLI_OK && report_count(r, REPORT_OTHER) == r->n)
        code = cli_failure(NAME, "%s: has no recording, model or result of palpate", o->words[0]);
    report_sort(r);
    code = code ? code : report_pairs(r);
    return code ? code : page_save(NAME, report_json(r, o->title ? o->title : "Palpation report"), o->out);
}

int cmd_report(int argc, char **argv) {
    report_options *o = calloc(1, sizeof *o);
    report r = {.file = calloc(REPORT_FILES_MAX, sizeof *r.file)};
    int code =
        o && r.file ? parse(argc, argv, o) : cli_failure(NAME, "%s", palp_status_text(PALP_ERR_NO_MEMORY));
    code = code ? code : make(o, &r);
    report_free(&r);
    free(o);
    return code == CLI_HELP ? CLI_OK : code;
}
