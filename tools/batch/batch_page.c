/* batch_page.c: the page of a batch: how its jobs ended, and what they found. */
#include "batch.h"
#include "shared/json_out.h"
#include "shared/page.h"

#include <palpate/version.h>
#include <stdlib.h>
#include <string.h>

void batch_last_words(const char *out, const batch_job *job, char line[256]) {
    char path[BATCH_PATH_MAX], text[256];
    batch_path(path, out, job->name, ".err");
    FILE *from = fopen(path, "r");
    line[0] = '\0';
    if (from && fseek(from, -4096, SEEK_END) != 0)
        rewind(from);
    while (from && fgets(text, sizeof text, from)) {
        text[strcspn(text, "\n")] = '\0';
        if (*text)
            memcpy(line, text, sizeof text);
    }
    if (from)
        fclose(from);
}

static json_t *job_json(const char *out, const batch_job *job, json_t *row) {
    char words[256] = "";
    if (job->ended && job->status)
        batch_last_words(out, job, words);
    json_t *to = json_object();
    json_object_set_new(to, "name", json_text(job->name));
    json_object_set_new(to, "status", job->ended ? json_integer(job->status) : json_null());
    json_object_set_new(to, "seconds", job->ended ? json_real(job->seconds) : json_null());
    json_object_set_new(to, "words", json_text(words));
    json_object_set(to, "values", row);
    return to;
}

int batch_page_save(const char *out, const batch_plan *plan, const batch_table *table) {
    char path[BATCH_PATH_MAX];
    const char *name;
    json_t *number, *columns = json_array(), *jobs = json_array();
    json_object_foreach(table->columns, name, number) json_array_append_new(columns, json_text(name));
    for (size_t i = 0; i < plan->n; i++)
        json_array_append_new(jobs, job_json(out, &plan->job[i], table->row[i]));
    batch_path(path, out, "index", ".html");
    return page_save(BATCH_NAME,
                     json_pack("{s:{s:i, s:s}, s:o, s:o}", "palpate", "batch_result", 1, "version",
                               palp_version(), "columns", columns, "jobs", jobs),
                     path);
}
