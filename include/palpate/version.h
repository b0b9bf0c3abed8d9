/* version.h: the library's version. Stable. */
#ifndef PALPATE_VERSION_H
#define PALPATE_VERSION_H

#include <palpate/export.h>

/* A change of what the headers declare changes the library's soname: before 1.0 with the minor version, from
 * then on with the major one. The first comment of each header says what to expect of the next minor version.
 * Stable: it is meant to stay as it is; what has to go is kept beside the new one for one minor version.
 * May change: names, structures and results may differ. */
#define PALP_VERSION "0.1.0"
#define PALP_VERSION_MAJOR 0
#define PALP_VERSION_MINOR 1
#define PALP_VERSION_PATCH 0

/* For the preprocessor: #if PALP_VERSION_NUMBER >= 100, for 0.1.0. */
#define PALP_VERSION_NUMBER (10000 * PALP_VERSION_MAJOR + 100 * PALP_VERSION_MINOR + PALP_VERSION_PATCH)

#ifdef __cplusplus
extern "C" {
#endif

/* The version of the library that runs, e.g. "0.1.0"; compare with PALP_VERSION of the headers. */
PALP_API const char *palp_version(void);

#ifdef __cplusplus
}
#endif
#endif
