/* page.h: the one page of results: explain, characterize, calibrate and report write it. */
#ifndef PALPATE_PAGE_H
#define PALPATE_PAGE_H

#include <jansson.h>
#include <stdbool.h>

/* Writes tools/page with the result inside, which its script draws; frees the result; an exit code. NULL
 * path = standard output, NULL result = out of memory. */
int page_save(const char *name, json_t *result, const char *path);

/* Where a command's result goes, and frees both: as --json has it to standard output, and with its figures
 * into --result and onto the page of --report. NULL = not asked for. An exit code. */
int page_result(const char *name, json_t *result, json_t *figures, bool json, const char *result_path,
                const char *report_path);

#endif
