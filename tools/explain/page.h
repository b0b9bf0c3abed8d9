/* page.h: the parts of what palpate explain found, each drawn from its result as JSON. */
#ifndef PALPATE_TOOL_PAGE_H
#define PALPATE_TOOL_PAGE_H

#include "shared/cli.h"
#include "shared/html.h"
#include "shared/json_out.h"

#include <palpate/palpate.h>
#include <palpate/explain.h>

enum { PAGE_LINE = 512 };

/* ---- page_found.c ---- */
#define PAGE_RESIDUALS                                                                                       \
    "Recorded minus model: orange as given, blue with the effects (lines: means, tint: lowest and "          \
    "highest), grey the noise level. At most the twelve runs with the largest gap."
void page_in_short(FILE *to, const json_t *result); /* of palpate explain: the verdict and what is missing, in
                                                       a box; links to #explain */
void page_found(FILE *to,
                const json_t *result); /* of palpate explain: the verdict, what is missing, in which phases */
void page_how(FILE *to,
              const json_t *result); /* likewise: the candidates, the residual, what to measure next */

/* ---- page_words.c ---- */
/* As a sentence; unexplained_N: what is more than noise, which where it agrees is below the practical limit.
 */
const char *page_verdict(const char *name, double unexplained_N);
const char *page_effect(const char *id);         /* its name in words */
const char *page_effect_means(const char *id);   /* what it does, a sentence */
const char *page_effect_seen_by(const char *id); /* what an experiment must contain */
void page_parameter(const char *key, char name[48], char unit[16]);
void page_phase(const char *id, char text[32]);
const char *page_force(double force_N, char text[32]); /* in N to pN; returns text */
void page_names(const json_t *ids, size_t from, const char *between,
                char line[PAGE_LINE]); /* those from one on */
void page_paragraph(FILE *to, const char *format, ...);

/* ---- page_story.c ---- */
enum { PAGE_STORY = 16, PAGE_CANDIDATES = 3 };

/* Sentences: the verdict, the gap, what else differs, what remains, what could be taken for what. */
typedef struct page_story {
    size_t n;
    char line[PAGE_STORY][PAGE_LINE];
} page_story;

void page_story_tell(const json_t *all, page_story *story);
bool page_one_recording(const json_t *all);

/* Of the candidates that gain anything and were not taken the one that gains most after last, or NULL; last
 * NULL: the first. */
const json_t *page_candidate(const json_t *all, const json_t *last);
void explain_say(FILE *to,
                 const json_t *all); /* the story, effects, candidates and the next step: for a terminal */

/* Whether a member is a number at all; one that is, within 0 and 1. */
bool page_has_share(const json_t *object, const char *key);
double page_share(const json_t *object, const char *key);

/* ---- page_bars.c ---- */
typedef struct page_bar {
    char label[64];
    double before, after; /* N; NAN = none */
} page_bar;

/* A figure with one or two bars a row, and a line at the noise level. */
void page_bars(FILE *to, const char *caption, size_t n, const page_bar *bar, double noise_level_N);

/* ---- page_phases.c, page_diagnostics.c, page_search.c, page_next.c: the sections ---- */
void page_phases(FILE *to, const json_t *all);
void page_diagnostics(FILE *to, const json_t *all);
void page_search(FILE *to, const json_t *all);
void page_next(FILE *to, const json_t *all);
void page_next_text(const json_t *all, char text[2 * PAGE_LINE]); /* what to measure next, in words */

#endif
