/* file.h: one-line errors, and functions that read and write files. */
#ifndef PALP_FILE_H
#define PALP_FILE_H

#include <palpate/file.h>
#include <stddef.h>

#if defined(__GNUC__)
#define PALP_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define PALP_PRINTF(text, first)
#endif

/* Sets *error (NULL is fine) to status and the formatted text, as one line: control characters become '?'.
 * Returns status. */
palp_status palp_error_set(palp_error *error, palp_status status, const char *format, ...) PALP_PRINTF(3, 4);

/* The same with "path:line: " in front. */
palp_status palp_error_set_line(palp_error *error, palp_status status, const char *path, size_t line,
                                const char *format, ...) PALP_PRINTF(5, 6);

/* ERR_ARGUMENT: a pointer that the call needs is NULL. */
palp_status palp_error_null(palp_error *error);

/* ERR_FILE with "path: what: the system's reason for number" (an errno). */
palp_status palp_error_set_file(palp_error *error, const char *path, const char *what, int number);

/* A copy of the text, which the caller frees; NULL: out of memory. */
char *palp_text_copy(const char *text);

#endif
