/* file.h: one-line errors, reading a whole file, and writing one that is never half there. */
#ifndef PALP_FILE_H
#define PALP_FILE_H

#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#if defined(__GNUC__)
#define PALP_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define PALP_PRINTF(text, first)
#endif

/* Fills *error (NULL is fine) with status and the formatted text, made one line: control characters
 * become '?'. Returns status. */
palp_status palp_error_set(palp_error *error, palp_status status, const char *format, ...) PALP_PRINTF(3, 4);

/* The same with "path:line: " in front. */
palp_status palp_error_set_line(palp_error *error, palp_status status, const char *path, size_t line,
                                const char *format, ...) PALP_PRINTF(5, 6);

/* ERR_FILE with "path: what: the system's reason for number" (an errno). */
palp_status palp_error_set_file(palp_error *error, const char *path, const char *what, int number);

/* Reads a whole file: *size bytes and a NUL after them, malloc'ed; the caller frees *text. */
palp_status palp_file_read(const char *path, char **text, size_t *size, palp_error *error);

/* A file being written under a temporary name beside its target. A target that is no regular file
 * (a pipe, /dev/stdout) is written directly. */
typedef struct palp_file {
    FILE *stream;     /* to write to; errors are looked at by commit */
    const char *path; /* as given, for errors; caller's */
    char *target;     /* path with symbolic links resolved */
    char *temporary;  /* "" when written directly */
} palp_file;

/* Opens; on success it must end in commit or abandon. */
palp_status palp_file_begin(palp_file *file, const char *path, palp_error *error);

/* Closes and renames to the target; with durable the bytes are on the disk before the rename. On
 * failure the temporary is removed and the target is as it was. */
palp_status palp_file_commit(palp_file *file, bool durable, palp_error *error);

/* Closes and removes the temporary. */
void palp_file_abandon(palp_file *file);

#endif
