/* import_rate.c: a time for tables that have none: by --rate, or the sampling rate in the file. */
#include "import.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Sampling interval, s; 0 = neither option nor file gives it. */
static double step_of(const import_options *o, const import_source *s, const char **from) {
    *from = "--rate";
    if (o->rate_Hz > 0)
        return 1 / o->rate_Hz;
    double rate = import_part(s, PART_RATE, from);
    return rate > 0 ? 1 / rate : import_part(s, PART_INTERVAL, from);
}

bool import_rate_known(const import_options *o, const import_source *s) {
    const char *from;
    return step_of(o, s, &from) > 0;
}

/* Appends a column. */
static bool widen(import_source *s) {
    size_t n = s->n_columns;
    double *value = realloc(s->value, (s->rows ? s->rows : 1) * (n + 1) * sizeof *value);
    if (!value)
        return false;
    for (size_t i = s->rows; i-- > 0;)
        memmove(value + i * (n + 1), value + i * n, n * sizeof *value);
    s->value = value;
    s->capacity = s->rows;
    s->n_columns = n + 1;
    return true;
}

int import_rate(const import_options *o, import_source *s) {
    const char *from;
    double step = step_of(o, s, &from);
    if (!(step > 0) || s->n_columns == IMPORT_COLUMNS || (!(o->rate_Hz > 0) && import_has_time(o, s)))
        return CLI_OK;
    if (!widen(s))
        return cli_failure("import", "%s: out of memory", s->file);
    size_t time = s->n_columns - 1;
    snprintf(s->column[time], IMPORT_WORD, "Time by %.40s (s)", from);
    s->clock[time] = false;
    s->rated = true;
    for (size_t i = 0; i < s->rows; i++)
        s->value[i * s->n_columns + time] = import_digits((double)i * step, (double)i * step);
    return CLI_OK;
}
