/* report_explain.h: the parts of what palpate explain found, each drawn from its result as JSON. */
#ifndef PALPATE_TOOL_REPORT_EXPLAIN_H
#define PALPATE_TOOL_REPORT_EXPLAIN_H

#include "report.h"

enum { REPORT_LINE = 512 };

/* ---- report_words.c ---- */
const char *report_effect_means(const char *id);   /* what it does, a sentence */
const char *report_effect_seen_by(const char *id); /* what an experiment must contain */
void report_parameter(const char *key, char name[48], char unit[16]);
void report_phase(const char *id, char text[32]);
const char *report_force(double force_N, char text[32]); /* in N, mN or uN; returns text */
void report_names(const json_t *ids, size_t from, const char *between, char line[REPORT_LINE]); /* those from one on */
void report_paragraph(FILE *to, const char *format, ...);

/* ---- report_bars.c ---- */
typedef struct report_bar {
    char label[64];
    double before, after; /* N; NAN = none */
} report_bar;

/* A figure with one or two bars a row, and a line at the noise level. */
void report_bars(FILE *to, const char *caption, size_t n, const report_bar *bar, double noise_level_N);

/* ---- report_phases.c, report_diagnostics.c, report_search.c, report_next.c: the sections ---- */
void report_phases(FILE *to, const json_t *all);
void report_diagnostics(FILE *to, const json_t *all);
void report_search(FILE *to, const json_t *all);
void report_next(FILE *to, const json_t *all);

#endif
