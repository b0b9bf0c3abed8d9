/* file.h: reading a whole file, and writing one that is never half there. Stable. */
#ifndef PALPATE_FILE_H
#define PALPATE_FILE_H

#include <palpate/status.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a whole file: *size bytes and a NUL after them, malloc'ed; the caller frees *text. */
PALP_API palp_status palp_file_read(const char *path, char **text, size_t *size, palp_error *error);

/* Makes any bytes, such as a file's name, a line of UTF-8 that a terminal, JSON or a page can show: each byte
 * of a control character, of what changes the direction of writing, or of what is no UTF-8 becomes '?'.
 * Returns text. */
PALP_API char *palp_text_make_plain(char *text);

/* A file being written under a temporary name TARGET.PID.N.tmp beside its target. A symbolic link is
 * followed, also to a file that is not there yet; a file that is replaced keeps its permissions. A target
 * that is no regular file (a pipe, a device) is written directly, and so is /dev/stdout, whatever it is. A
 * program that a signal ends may remove what its process left. */
typedef struct palp_file {
    FILE *stream;     /* to write to; errors are looked at by commit */
    const char *path; /* as given, for errors; caller's */
    char *target;     /* path with symbolic links resolved */
    char *temporary;  /* "" when written directly */
} palp_file;

/* Opens; on success it must end in commit or abandon. */
PALP_API palp_status palp_file_begin(palp_file *file, const char *path, palp_error *error);

/* Closes and renames to the target; with durable the bytes are on the disk before the rename. On
 * failure the temporary is removed and the target is as it was. */
PALP_API palp_status palp_file_commit(palp_file *file, bool durable, palp_error *error);

/* Closes and removes the temporary. */
PALP_API void palp_file_abandon(palp_file *file);

/* The same for two files that belong together: neither target is touched before both are written whole. */
PALP_API palp_status palp_file_commit_pair(palp_file *first, palp_file *second, bool durable,
                                           palp_error *error);

#ifdef __cplusplus
}
#endif
#endif
