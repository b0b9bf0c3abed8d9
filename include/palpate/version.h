/* version.h: the library's version. */
#ifndef PALPATE_VERSION_H
#define PALPATE_VERSION_H

#include <palpate/export.h>

#define PALP_VERSION "0.1.0"

#ifdef __cplusplus
extern "C" {
#endif

/* The version of the library that runs, e.g. "0.1.0"; compare with PALP_VERSION of the headers. */
PALP_API const char *palp_version(void);

#ifdef __cplusplus
}
#endif
#endif
