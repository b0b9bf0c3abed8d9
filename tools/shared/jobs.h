/* jobs.h: tasks on several threads. */
#ifndef PALPATE_JOBS_H
#define PALPATE_JOBS_H

#include <palpate/explain.h>

/* Runs task(work, 0) ... task(work, n - 1) on *(const size_t *)user threads and waits for them. */
palp_explain_loop jobs_run;

#endif
