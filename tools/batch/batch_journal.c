/* batch_journal.c: what has ended, one line a job, on the disk before the next one is added. */
#define _XOPEN_SOURCE 700
#include "batch.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { ENCODED_MAX = 3 * BATCH_NAME_MAX + 1, LINE_MAX_BYTES = ENCODED_MAX + 128 };

static const char HEAD[] =
    "# name, CRC-32 of the arguments, exit status, seconds, end (seconds since 1970)\n";

typedef struct entry {
    char name[BATCH_NAME_MAX + 1];
    uint32_t hash;
    int status;
    double seconds, at_s;
} entry;

/* A name as one word: bytes that are no visible ASCII, % and # as %XX. */
static void encode(const char *name, char word[ENCODED_MAX]) {
    size_t n = 0;
    for (const unsigned char *at = (const unsigned char *)name; *at; at++)
        if (*at > ' ' && *at < 0x7f && *at != '%' && *at != '#')
            word[n++] = (char)*at;
        else
            n += (size_t)snprintf(word + n, ENCODED_MAX - n, "%%%02x", (unsigned)*at);
    word[n] = '\0';
}

static bool decode(const char *word, char name[BATCH_NAME_MAX + 1]) {
    size_t n = 0;
    for (; *word && n < BATCH_NAME_MAX; n++) {
        unsigned byte = (unsigned char)*word;
        int used = 1;
        if (*word == '%' && (sscanf(word, "%%%2x%n", &byte, &used) != 1 || byte == 0))
            return false;
        name[n] = (char)byte;
        word += used;
    }
    name[n] = '\0';
    return !*word;
}

static bool read_line(const char *line, entry *e) {
    char word[ENCODED_MAX];
    int end = -1;
    return sscanf(line, "%720s %8" SCNx32 " %d %lf %lf%n", word, &e->hash, &e->status, &e->seconds, &e->at_s,
                  &end) == 5 &&
           end >= 0 && !line[end] && isfinite(e->seconds) && isfinite(e->at_s) && decode(word, e->name);
}

static int compare_name(const void *name, const void *job) {
    return strcmp(name, (*(batch_job *const *)job)->name);
}

/* The line that ended last counts, whichever journal it is in: the job's files are of its arguments. */
static void take(batch_plan *plan, const entry *e) {
    batch_job **found = bsearch(e->name, plan->by_name, plan->n, sizeof *plan->by_name, compare_name);
    batch_job *job = found ? *found : NULL;
    if (!job || job->at_s > e->at_s)
        return;
    job->ended = job->hash == e->hash;
    job->status = e->status;
    job->seconds = e->seconds;
    job->at_s = e->at_s;
}

/* Takes over the entries of a journal and copies its lines; either may be NULL. A last line without an end
 * is what a killed batch left: it is none. */
static int read_journal(const char *path, batch_plan *plan, FILE *copy) {
    char *text = NULL, *end;
    size_t size = 0, number = 1;
    palp_error error;
    entry e;
    palp_status status = palp_file_read(path, &text, &size, &error);
    int code = status ? cli_status(BATCH_NAME, status, &error) : CLI_OK;
    for (char *line = text; code == CLI_OK && (end = strchr(line, '\n')) != NULL; line = end + 1, number++) {
        *end = '\0';
        if (line[0] == '#')
            continue;
        if (!read_line(line, &e))
            code = cli_failure(BATCH_NAME, "%s:%zu: is no line of a journal", path, number);
        else if (plan)
            take(plan, &e);
        if (code == CLI_OK && copy)
            fprintf(copy, "%s\n", line);
    }
    free(text);
    return code;
}

static int is_numbered(const struct dirent *file) {
    static const char start[] = "journal.";
    const size_t n = sizeof start - 1;
    return strncmp(file->d_name, start, n) == 0 && file->d_name[n] &&
           !file->d_name[n + strspn(file->d_name + n, "0123456789")];
}

/* Calls read_journal for that of the folder and for those of tasks. *tasks is the number of the latter. */
static int read_all(const char *out, batch_plan *plan, FILE *copy, int *tasks) {
    char path[BATCH_PATH_MAX];
    struct dirent **list = NULL;
    struct stat there;
    int code = CLI_OK, n = scandir(out, &list, is_numbered, alphasort);
    if (n < 0)
        return cli_failure(BATCH_NAME, "%s: cannot read: %s", out, strerror(errno));
    batch_path(path, out, "journal", "");
    if (stat(path, &there) == 0)
        code = read_journal(path, plan, copy);
    for (int i = 0; i < n; i++) {
        batch_path(path, out, list[i]->d_name, "");
        code = code ? code : read_journal(path, plan, copy);
        if (code == CLI_OK && !plan && !copy && unlink(path) != 0)
            code = cli_failure(BATCH_NAME, "%s: cannot remove: %s", path, strerror(errno));
        free(list[i]);
    }
    free(list);
    *tasks = n;
    return code;
}

/* A job has not ended if its files are gone. */
static void check_files(const char *out, batch_plan *plan) {
    char path[BATCH_PATH_MAX];
    struct stat there;
    for (size_t i = 0; i < plan->n; i++) {
        batch_job *job = &plan->job[i];
        for (int k = 0; k < 2 && job->ended; k++) {
            batch_path(path, out, job->name, k ? ".err" : ".out");
            job->ended = stat(path, &there) == 0;
        }
    }
}

int batch_journal_load(const char *out, batch_plan *plan) {
    int tasks, code = read_all(out, plan, NULL, &tasks);
    if (code == CLI_OK)
        check_files(out, plan);
    return code;
}

int batch_journal_merge(const char *out) {
    char path[BATCH_PATH_MAX];
    palp_file file;
    palp_error error;
    int tasks = 0;
    batch_path(path, out, "journal", "");
    int code = cli_file_open(BATCH_NAME, path, &file);
    if (code)
        return code;
    fputs(HEAD, file.stream);
    code = read_all(out, NULL, file.stream, &tasks);
    if (code || tasks == 0) {
        palp_file_abandon(&file);
        return code;
    }
    palp_status status = palp_file_commit(&file, true, &error);
    return status ? cli_status(BATCH_NAME, status, &error) : read_all(out, NULL, NULL, &tasks);
}

/* Cuts off a last line that has no end; true = something is left. */
static bool cut_torn_line(int fd, off_t size) {
    char byte = '\n';
    while (size > 0 && pread(fd, &byte, 1, size - 1) == 1 && byte != '\n')
        size--;
    return ftruncate(fd, size) == 0 && size > 0;
}

static int write_line(const char *path, int fd, const char *line) {
    size_t n = strlen(line);
    off_t before = lseek(fd, 0, SEEK_END);
    errno = 0;
    ssize_t written = write(fd, line, n);
    if (written == (ssize_t)n && fsync(fd) == 0)
        return CLI_OK;
    int number = errno ? errno : ENOSPC;
    if (before >= 0 && ftruncate(fd, before) != 0)
        number = errno; /* the torn line stays, and is cut off by the next run */
    return cli_failure(BATCH_NAME, "%s: cannot write: %s", path, strerror(number));
}

int batch_journal_open(const batch_options *o, int *fd) {
    char path[BATCH_PATH_MAX];
    struct stat file;
    batch_journal_path(path, o);
    *fd = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (*fd < 0 || fstat(*fd, &file) != 0)
        return cli_failure(BATCH_NAME, "%s: cannot write: %s", path, strerror(errno));
    return cut_torn_line(*fd, file.st_size) ? CLI_OK : write_line(path, *fd, HEAD);
}

int batch_journal_add(const batch_options *o, int fd, const batch_job *job) {
    char path[BATCH_PATH_MAX], word[ENCODED_MAX], line[LINE_MAX_BYTES];
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    encode(job->name, word);
    snprintf(line, sizeof line, "%s %08" PRIx32 " %d %.3f %.3f\n", word, job->hash, job->status, job->seconds,
             (double)now.tv_sec + 1e-9 * (double)now.tv_nsec);
    batch_journal_path(path, o);
    return write_line(path, fd, line);
}
