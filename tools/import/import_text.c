/* import_text.c: a text file for palpate import: lines, fields, numbers. */
#include "import.h"
#include "shared/crc32.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";

/* All of the stream, with a NUL after it. */
static char *read_all(FILE *stream, size_t *size) {
    size_t capacity = 1 << 16, n = 0;
    char *text = malloc(capacity);
    while (text) {
        n += fread(text + n, 1, capacity - n - 1, stream);
        if (n < capacity - 1) {
            text[n] = '\0';
            *size = n;
            return text;
        }
        char *larger = realloc(text, capacity *= 2);
        if (!larger) {
            free(text);
        }
        text = larger;
    }
    return NULL;
}

int import_text_read(const char *file, import_text *text) {
    memset(text, 0, sizeof *text);
    text->file = file;
    FILE *stream = fopen(file, "rb");
    if (!stream) {
        return cli_failure(NAME, "%s: %s", file, strerror(errno));
    }
    text->text = read_all(stream, &text->size);
    bool bad = ferror(stream) != 0;
    int number = errno;
    fclose(stream);
    if (!text->text || bad) {
        return cli_failure(NAME, "%s: %s", file, bad ? strerror(number) : "out of memory");
    }
    if (memchr(text->text, '\0', text->size)) {
        return cli_failure(NAME, "%s: not a text file (or UTF-16: save it as UTF-8)", file);
    }
    text->crc32 = crc32_add(0, text->text, text->size);
    text->at = strncmp(text->text, "\xEF\xBB\xBF", 3) == 0 ? text->text + 3 : text->text;
    return CLI_OK;
}

void import_text_free(import_text *text) {
    free(text->text);
    memset(text, 0, sizeof *text);
}

char *import_line(import_text *text) {
    char *line = text->at;
    if (!line || !*line) {
        return NULL;
    }
    size_t n = strcspn(line, "\n");
    text->at = line[n] ? line + n + 1 : NULL;
    line[n] = '\0';
    if (n > 0 && line[n - 1] == '\r') {
        line[n - 1] = '\0';
    }
    text->line++;
    return line;
}

static char *trim(char *field) {
    field += strspn(field, " \t");
    size_t n = strlen(field);
    while (n > 0 && (field[n - 1] == ' ' || field[n - 1] == '\t')) {
        n--;
    }
    if (n >= 2 && field[0] == '"' && field[n - 1] == '"') {
        field++;
        n -= 2;
    }
    field[n] = '\0';
    return field;
}

size_t import_split(char *line, char separator, char *fields[IMPORT_COLUMNS]) {
    size_t n = 0, filled = 0;
    for (char *at = line; at && n < IMPORT_COLUMNS; n++) {
        bool quoted = false;
        char *end = at;
        while (*end && (quoted || *end != separator)) {
            quoted = *end++ == '"' ? !quoted : quoted;
        }
        char *next = *end ? end + 1 : NULL;
        *end = '\0';
        fields[n] = trim(at);
        filled = *fields[n] ? n + 1 : filled;
        at = next;
    }
    return filled;
}

bool import_number(const char *field, char separator, double *value) {
    char copy[64];
    size_t n = strlen(field);
    if (n == 0 || n >= sizeof copy || strspn(field, "+-.,0123456789eE") != n) {
        return false;
    }
    memcpy(copy, field, n + 1);
    char *comma = strchr(copy, ',');
    if (comma && (separator == ',' || strchr(copy, '.'))) {
        return false;
    }
    if (comma) {
        *comma = '.';
    }
    return cli_read_number(copy, value);
}
