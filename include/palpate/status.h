/* status.h: what a fallible call returns, and the one-line error of calls that read files. Stable. */
#ifndef PALPATE_STATUS_H
#define PALPATE_STATUS_H

#include <palpate/export.h>

#ifdef __cplusplus
extern "C" {
#endif

/* X(name, text): the only list of status codes. */
#define PALP_STATUS_LIST(X)                                                                                  \
    X(OK, "success")                                                                                         \
    X(ERR_NO_MEMORY, "out of memory")                                                                        \
    X(ERR_ARGUMENT, "an argument is out of range")                                                           \
    X(ERR_INPUT, "malformed input")                                                                          \
    X(ERR_FILE, "a file cannot be read or written")                                                          \
    X(ERR_LIMIT, "more coefficients, arms or pairs in contact than there is room for")                       \
    X(ERR_UNSUPPORTED, "a combination that this build does not support")                                     \
    X(ERR_NOT_CONVERGED, "the iteration did not converge")                                                   \
    X(ERR_BUCKLED, "no equilibrium found past a loss of stability")                                          \
    X(ERR_SINGULAR, "the tangent is singular: a mechanism or a disconnected node")                           \
    X(ERR_COLLAPSED, "an element has collapsed to zero length")                                              \
    X(ERR_STOPPED, "stopped by the caller")                                                                  \
    X(ERR_INSIDE, "a tool is inside the tissue and touches no part of its surface")

typedef enum palp_status {
#define PALP_STATUS_MEMBER(name, text) PALP_##name,
    PALP_STATUS_LIST(PALP_STATUS_MEMBER)
#undef PALP_STATUS_MEMBER
        PALP_STATUS_COUNT
} palp_status;

/* NULL pointers: a call that gets NULL for something it needs changes nothing. It returns PALP_ERR_ARGUMENT,
 * or 0, false, NULL or, for a double, NaN. May be NULL in all calls: palp_error *, info, user, what is to be
 * freed, and arrays without elements. Other pointers that may be NULL are named at the call. */

/* One English line for a status, "unknown status" for a value outside the list. Never NULL. */
PALP_API const char *palp_status_text(palp_status status);

/* The name of a status as it is written in C, e.g. "PALP_ERR_INPUT". Never NULL. */
PALP_API const char *palp_status_name(palp_status status);

enum { PALP_ERROR_TEXT = 512 };

/* Where and why a call failed: text is one line, "run.csv:41: ..." where a file is to blame.
 * Calls that take a palp_error * accept NULL and leave it untouched on success. */
typedef struct palp_error {
    palp_status status;
    char text[PALP_ERROR_TEXT];
} palp_error;

#ifdef __cplusplus
}
#endif
#endif
