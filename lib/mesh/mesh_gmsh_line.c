/* mesh_gmsh_line.c: what reads a Gmsh file by lines and tokens: numbers, growing lists, errors with line
 * numbers. */
#define _POSIX_C_SOURCE 200809L /* locale_t */
#include "mesh_gmsh.h"
#include "base/number.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

palp_status gmsh_fail(const gmsh_file *r, size_t line, const char *format, ...) {
    char what[PALP_ERROR_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(what, sizeof what, format, arguments);
    va_end(arguments);
    return palp_error_set(r->error, PALP_ERR_INPUT, "%s:%zu: %s", r->path, line > 0 ? line : 1, what);
}

palp_status gmsh_no_memory(const gmsh_file *r) {
    return palp_error_set(r->error, PALP_ERR_NO_MEMORY, "%s: out of memory", r->path);
}

palp_status gmsh_append(const gmsh_file *r, gmsh_list *l, size_t size, void **item) {
    if (l->n == l->room) {
        size_t room = l->room > 0 ? 2 * l->room : 64;
        void *items = room > SIZE_MAX / size ? NULL : realloc(l->items, room * size);
        if (!items)
            return gmsh_no_memory(r);
        l->items = items;
        l->room = room;
    }
    *item = (char *)l->items + size * l->n++;
    return PALP_OK;
}

static bool is_white_space(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

bool gmsh_next(gmsh_file *r) {
    while (r->next < r->end) {
        char *line = r->next, *stop = memchr(line, '\n', (size_t)(r->end - line));
        stop = stop ? stop : r->end;
        r->next = stop < r->end ? stop + 1 : r->end;
        r->line++;
        while (line < stop && is_white_space(*line))
            line++;
        while (stop > line && is_white_space(stop[-1]))
            stop--;
        *stop = '\0'; /* at the end of the file there is a NUL already */
        r->at = line;
        if (line < stop)
            return true;
    }
    return false;
}

palp_status gmsh_line(gmsh_file *r) {
    return gmsh_next(r) ? PALP_OK : gmsh_fail(r, r->line, "the file ends inside %s", r->section);
}

palp_status gmsh_fail_token(const gmsh_file *r, const char *expected) {
    int length = (int)strcspn(r->at, " \t");
    if (length == 0)
        return gmsh_fail(r, r->line, "the line ends where %s is expected", expected);
    return gmsh_fail(r, r->line, "%s is expected, not '%.*s'", expected, length < 40 ? length : 40, r->at);
}

void gmsh_skip(gmsh_file *r) {
    while (is_white_space(*r->at))
        r->at++;
}

palp_status gmsh_integer(gmsh_file *r, const char *what, long long low, long long high, long long *value) {
    gmsh_skip(r);
    char *stop;
    errno = 0;
    long long n = strtoll(r->at, &stop, 10);
    if (stop == r->at || (*stop && !is_white_space(*stop)))
        return gmsh_fail_token(r, what);
    if (errno == ERANGE || n < low || n > high)
        return gmsh_fail(r, r->line, "%s of %.*s is out of range", what,
                         (int)(stop - r->at < 40 ? stop - r->at : 40), r->at);
    r->at = stop;
    *value = n;
    return PALP_OK;
}

palp_status gmsh_count(gmsh_file *r, const char *what, size_t *count) {
    long long n = 0;
    palp_status status = gmsh_integer(r, what, 0, INT32_MAX, &n);
    *count = (size_t)n;
    return status;
}

palp_status gmsh_number(gmsh_file *r, const char *what, double *value) {
    gmsh_skip(r);
    const char *stop = palp_number_parse(r->at, value);
    if (!stop || (*stop && !is_white_space(*stop)))
        return gmsh_fail_token(r, what);
    if (!isfinite(*value))
        return gmsh_fail(r, r->line, "%s is out of range", what);
    r->at += stop - r->at;
    return PALP_OK;
}

palp_status gmsh_line_end(gmsh_file *r) {
    gmsh_skip(r);
    return *r->at ? gmsh_fail_token(r, "the end of the line") : PALP_OK;
}
