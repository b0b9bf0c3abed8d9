/* file.c: one-line errors, reading a whole file, and writing a file all or nothing. */
#define _XOPEN_SOURCE 700 /* realpath, fsync, strerror_r */
#include "file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void format_error_text(palp_error *error, size_t from, const char *format, va_list arguments) {
    if (from < sizeof error->text)
        vsnprintf(error->text + from, sizeof error->text - from, format, arguments);
    palp_text_make_plain(error->text);
}

palp_status palp_error_set(palp_error *error, palp_status status, const char *format, ...) {
    if (!error)
        return status;
    error->status = status;
    va_list arguments;
    va_start(arguments, format);
    format_error_text(error, 0, format, arguments);
    va_end(arguments);
    return status;
}

palp_status palp_error_set_line(palp_error *error, palp_status status, const char *path, size_t line,
                                const char *format, ...) {
    if (!error)
        return status;
    error->status = status;
    int from = snprintf(error->text, sizeof error->text, "%s:%zu: ", path, line);
    va_list arguments;
    va_start(arguments, format);
    format_error_text(error, from > 0 ? (size_t)from : 0, format, arguments);
    va_end(arguments);
    return status;
}

palp_status palp_error_null(palp_error *error) {
    return palp_error_set(error, PALP_ERR_ARGUMENT, "a required pointer is NULL");
}

palp_status palp_error_set_file(palp_error *error, const char *path, const char *what, int number) {
    char reason[128] = "";
    if (strerror_r(number, reason, sizeof reason) || !reason[0])
        snprintf(reason, sizeof reason, "error %d", number);
    size_t n = strlen(path),
           most = PALP_ERROR_TEXT / 2; /* of a longer path only the end, so that the reason fits */
    return palp_error_set(error, PALP_ERR_FILE, "%s%s: %s: %s", n > most ? "..." : "",
                          n > most ? path + n - most : path, what, reason);
}

/* Buffer for a file: its size if it is a regular file, otherwise a first guess. */
static size_t guess_stream_size(FILE *stream) {
    struct stat info;
    if (fstat(fileno(stream), &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0)
        return (size_t)info.st_size + 2; /* for the NUL, and one more so that fread finds the end */
    return 65536;
}

static palp_status read_stream_to_end(FILE *stream, char **text, size_t *size) {
    size_t capacity = guess_stream_size(stream), n = 0;
    char *buffer = malloc(capacity);
    while (buffer) {
        n += fread(buffer + n, 1, capacity - 1 - n, stream);
        if (n + 1 < capacity)
            break;
        char *larger = capacity > (size_t)-1 / 2 ? NULL : realloc(buffer, 2 * capacity);
        if (!larger)
            free(buffer);
        buffer = larger;
        capacity *= 2;
    }
    *text = buffer ? realloc(buffer, n + 1) : NULL; /* no room behind it, where no reader may look */
    if (!*text) {
        free(buffer);
        return PALP_ERR_NO_MEMORY;
    }
    (*text)[n] = '\0';
    *size = n;
    return PALP_OK;
}

palp_status palp_file_read(const char *path, char **text, size_t *size, palp_error *error) {
    if (!path || !text || !size)
        return palp_error_null(error);
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return palp_error_set_file(error, path, "cannot open", errno);
    errno = 0;
    palp_status status = read_stream_to_end(stream, text, size);
    int number = errno;
    bool failed = ferror(stream) != 0;
    fclose(stream);
    if (status)
        return palp_error_set(error, status, "%s: %s", path, palp_status_text(status));
    if (failed) {
        free(*text);
        *text = NULL;
        return palp_error_set_file(error, path, "cannot read", number);
    }
    return PALP_OK;
}

char *palp_text_copy(const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = malloc(size);
    return copy ? memcpy(copy, text, size) : NULL;
}

static void release_file_paths(palp_file *file) {
    free(file->target);
    free(file->temporary);
    memset(file, 0, sizeof *file);
}

/* Opens target.PID.N.tmp for the first free N, with the permissions of the file that it replaces (NULL:
 * none). -1 with errno if that fails. */
static int open_temporary(palp_file *file, const struct stat *replaced) {
    enum { SUFFIX = 48, BASE_MOST = 255 - SUFFIX }; /* a file name has at most 255 bytes */
    const char *slash = strrchr(file->target, '/');
    size_t folder = slash ? (size_t)(slash + 1 - file->target) : 0, room = strlen(file->target) + SUFFIX;
    char *larger = realloc(file->temporary, room);
    if (!larger) {
        errno = ENOMEM;
        return -1;
    }
    file->temporary = larger;
    int fd = -1;
    for (int i = 0; i < 1000 && fd < 0; i++) {
        snprintf(file->temporary, room, "%.*s%.*s.%ld.%d.tmp", (int)folder, file->target, BASE_MOST,
                 file->target + folder, (long)getpid(), i);
        fd = open(file->temporary, O_WRONLY | O_CREAT | O_EXCL, replaced ? 0600 : 0666);
        if (fd < 0 && errno != EEXIST)
            break;
    }
    if (fd >= 0 && replaced) {
        if (fchown(fd, replaced->st_uid, replaced->st_gid) != 0)
            errno = 0; /* without the right to change the owner it stays */
        fchmod(fd, replaced->st_mode & 0777);
    }
    return fd;
}

static int open_output_target(palp_file *file) {
    struct stat info;
    if (strcmp(file->path, "/dev/stdout") == 0)
        return fflush(stdout) == 0 ? dup(STDOUT_FILENO) : -1;
    bool there = stat(file->target, &info) == 0;
    return there && !S_ISREG(info.st_mode) ? open(file->target, O_WRONLY)
                                           : open_temporary(file, there ? &info : NULL);
}

/* Replaces *path by the target of the symbolic link there; 0 or an errno, EINVAL if it is no link. */
static int follow_symbolic_link(char **path) {
    char to[PATH_MAX];
    ssize_t n = readlink(*path, to, sizeof to);
    if (n < 0)
        return errno;
    const char *slash = strrchr(*path, '/');
    size_t folder = slash && to[0] != '/' ? (size_t)(slash + 1 - *path) : 0;
    char *target = malloc(folder + (size_t)n + 1);
    if (!target)
        return ENOMEM;
    memcpy(target, *path, folder);
    memcpy(target + folder, to, (size_t)n);
    target[folder + (size_t)n] = '\0';
    free(*path);
    *path = target;
    return 0;
}

/* Resolves symbolic links, even if the last one's target does not exist; returns an errno. */
static int resolve_symbolic_links(const char *path, char **target) {
    enum { LINKS_MOST = 40 };
    struct stat info;
    *target = realpath(path, NULL);
    if (*target)
        return 0;
    *target = palp_text_copy(path);
    int number = *target ? 0 : ENOMEM;
    bool there = stat(path, &info) == 0; /* such as a pipe in /dev/fd, which has no path */
    for (int i = 0; i < LINKS_MOST && !there && !number; i++)
        number = follow_symbolic_link(target);
    return number == ENOMEM ? number : there || number ? 0 : ELOOP;
}

palp_status palp_file_begin(palp_file *file, const char *path, palp_error *error) {
    if (!file || !path)
        return palp_error_null(error);
    memset(file, 0, sizeof *file);
    file->path = path;
    int number = resolve_symbolic_links(path, &file->target), fd = -1;
    file->temporary = palp_text_copy("");
    number = file->temporary ? number : ENOMEM;
    if (!number) {
        fd = open_output_target(file);
        file->stream = fd >= 0 ? fdopen(fd, "wb") : NULL;
        number = errno;
    }
    if (file->stream)
        return PALP_OK;
    if (fd >= 0) {
        close(fd);
        if (file->temporary[0])
            unlink(file->temporary);
    }
    release_file_paths(file);
    if (number == ENOMEM)
        return palp_error_set(error, PALP_ERR_NO_MEMORY, "%s: out of memory", path);
    return palp_error_set_file(error, path, "cannot write", number);
}

/* Closes the file; 0, or the errno of the first failure since it was opened. If an earlier write failed and
 * its errno is lost, writing one more byte finds it again. */
static int flush_and_close_stream(palp_file *file, bool durable) {
    int fd = fileno(file->stream);
    errno = 0;
    bool bad = ferror(file->stream) != 0;
    bad = fflush(file->stream) != 0 || bad;
    if (bad && errno == 0 && write(fd, "\n", 1) >= 0)
        errno = EIO;
    if (!bad && durable && file->temporary[0])
        bad = fsync(fd) != 0;
    int number = bad ? errno : 0;
    if (fclose(file->stream) != 0 && !bad)
        number = errno;
    file->stream = NULL;
    return number;
}

static int rename_over_target(const palp_file *file) {
    return file->temporary[0] && rename(file->temporary, file->target) != 0 ? errno : 0;
}

/* Removes the unfinished file; returns the status for an errno. */
static palp_status clean_up_after_write(palp_file *file, int number, palp_error *error) {
    if (number && file->temporary[0])
        unlink(file->temporary);
    palp_status status = number ? palp_error_set_file(error, file->path, "cannot write", number) : PALP_OK;
    release_file_paths(file);
    return status;
}

palp_status palp_file_commit(palp_file *file, bool durable, palp_error *error) {
    if (!file)
        return palp_error_null(error);
    int number = flush_and_close_stream(file, durable);
    return clean_up_after_write(file, number ? number : rename_over_target(file), error);
}

palp_status palp_file_commit_pair(palp_file *first, palp_file *second, bool durable, palp_error *error) {
    if (!first || !second)
        return palp_error_null(error);
    int number = flush_and_close_stream(first, durable);
    if (number) {
        palp_file_abandon(second);
        return clean_up_after_write(first, number, error);
    }
    number = flush_and_close_stream(second, durable);
    if (number) {
        clean_up_after_write(first, number, NULL);
        return clean_up_after_write(second, number, error);
    }
    palp_status status = clean_up_after_write(first, rename_over_target(first), error);
    if (!status)
        return clean_up_after_write(second, rename_over_target(second), error);
    clean_up_after_write(second, EIO, NULL);
    return status;
}

void palp_file_abandon(palp_file *file) {
    if (!file)
        return;
    fclose(file->stream);
    if (file->temporary[0])
        unlink(file->temporary);
    release_file_paths(file);
}
