/* import_dialect.c: the separators of a file, between fields and in numbers. */
#include "import.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool digit(char c) {
    return c >= '0' && c <= '9';
}

static char *trim(char *field) {
    field += strspn(field, " \t");
    size_t n = strlen(field);
    while (n > 0 && (field[n - 1] == ' ' || field[n - 1] == '\t'))
        n--;
    if (n >= 2 && field[0] == '"' && field[n - 1] == '"') {
        field++;
        n -= 2;
    }
    field[n] = '\0';
    return field;
}

/* End of the field at a place; a blank as the separator stands for any number of blanks and tabs. */
static char *field_end(char *at, char separator) {
    bool quoted = false;
    while (*at && (quoted || !(*at == separator || (separator == ' ' && *at == '\t')))) {
        quoted = *at == '"' ? !quoted : quoted;
        at++;
    }
    return at;
}

size_t import_split(char *line, char separator, char *fields[IMPORT_COLUMNS]) {
    size_t n = 0, filled = 0;
    line += separator == ' ' ? strspn(line, " \t") : 0;
    for (char *at = line; at && n < IMPORT_COLUMNS; n++) {
        char *end = field_end(at, separator), *next = *end ? end + 1 : NULL;
        if (next && separator == ' ') {
            next += strspn(next, " \t");
            next = *next ? next : NULL;
        }
        *end = '\0';
        fields[n] = trim(at);
        filled = *fields[n] ? n + 1 : filled;
        at = next;
    }
    return filled;
}

/* Copies the number at the start of a field with a decimal point and without grouping; returns its length in
 * the field, 0 = none. */
static size_t copy_number(const char *field, const import_dialect *d, char copy[IMPORT_WORD]) {
    size_t i = 0, n = 0, group = 0;
    bool grouped = false, point = false, any = false;
    if (field[i] == '+' || field[i] == '-')
        copy[n++] = field[i++];
    for (; n + 2 < IMPORT_WORD; i++) {
        if (digit(field[i])) {
            copy[n++] = field[i];
            any = true;
            group++;
        } else if (!point && field[i] == d->decimal) {
            if (grouped && group != 3)
                return 0;
            copy[n++] = '.';
            point = true;
        } else if (!point && any && (field[i] == '\'' || field[i] == d->thousands) && field[i] &&
                   digit(field[i + 1])) {
            if (grouped ? group != 3 : group > 3)
                return 0;
            grouped = true;
            group = 0;
        } else {
            break;
        }
    }
    if (!any || (grouped && !point && group != 3))
        return 0;
    if (strchr("eEdD", field[i]) && field[i]) {
        size_t e = i + 1 + (field[i + 1] == '+' || field[i + 1] == '-');
        if (digit(field[e])) {
            copy[n++] = 'e';
            for (i++; n + 2 < IMPORT_WORD && (i < e || digit(field[i])); i++)
                copy[n++] = field[i];
        }
    }
    copy[n] = '\0';
    return i;
}

bool import_number_unit(const char *field, const import_dialect *d, double *value, const char **rest) {
    char copy[IMPORT_WORD];
    size_t n = copy_number(field, d, copy);
    *rest = field + n;
    return n > 0 && cli_read_number(copy, value);
}

bool import_number(const char *field, const import_dialect *d, double *value) {
    const char *rest;
    if (!import_number_unit(field, d, value, &rest))
        return false;
    rest += strspn(rest, " ");
    return !*rest || import_unit_any(rest);
}

/* Two or more whole numbers with the same separator; returns their length. */
static size_t read_parts(const char *text, char sign, double part[3], size_t *parts) {
    size_t at = 0;
    for (*parts = 0; *parts < 3; (*parts)++) {
        size_t n = 0;
        part[*parts] = 0;
        while (n < 9 && digit(text[at + n]))
            part[*parts] = 10 * part[*parts] + (text[at + n++] - '0');
        if (n == 0)
            break;
        at += n;
        if (*parts < 2 && text[at] == sign && digit(text[at + 1])) {
            at++;
            continue;
        }
        (*parts)++;
        break;
    }
    return at;
}

/* Days since 1970-01-01. */
static double days_from_1970(double year, double month, double day) {
    double y = month <= 2 ? year - 1 : year, era = floor(y / 400), of_era = y - 400 * era;
    double of_year = floor((153 * (month + (month > 2 ? -3 : 9)) + 2) / 5) + day - 1;
    return 146097 * era + 365 * of_era + floor(of_era / 4) - floor(of_era / 100) + of_year - 719468;
}

/* A date before a time: 2024-03-01, 01.03.2024, 3/1/2024; its length, 0 = none. */
static size_t read_date(const char *text, double *seconds) {
    static const char signs[] = "-./";
    for (size_t k = 0; signs[k]; k++) {
        double p[3];
        size_t parts, n = read_parts(text, signs[k], p, &parts);
        if (parts == 3 && (p[0] > 31 || p[2] > 31)) {
            double year = p[0] > 31 ? p[0] : p[2], day = p[0] > 31 ? p[2] : p[0], month = p[1];
            if (month > 12 || (signs[k] == '/' && p[0] <= 12 && day <= 12)) { /* month first */
                double other = day;
                day = month;
                month = other;
            }
            *seconds = month >= 1 && month <= 12 && day >= 1 && day <= 31
                           ? 86400 * days_from_1970(year, month, day)
                           : NAN;
            return isfinite(*seconds) ? n : 0;
        }
    }
    return 0;
}

bool import_clock(const char *text, double *seconds, bool *dated) {
    double date = 0, part[3] = {0}, fraction = 0;
    size_t parts, n = read_date(text, &date);
    *dated = n > 0;
    text += n;
    text += *dated && *text == 'T' ? 1 : strspn(text, " ,T");
    n = read_parts(text, ':', part, &parts);
    if (!*text && *dated) {
        *seconds = date;
        return true;
    }
    text += n;
    if (parts < 2)
        return false;
    if ((*text == '.' || *text == ',' || *text == ':') && digit(text[1])) {
        double scale = 0.1;
        for (text++; digit(*text); text++, scale /= 10)
            fraction += scale * (*text - '0');
    }
    text += strspn(text, " ");
    bool afternoon = (*text == 'P' || *text == 'p') && part[0] < 12,
         midnight = (*text == 'A' || *text == 'a') && part[0] == 12;
    if (*text && !strchr("AaPpZ", *text))
        return false;
    *seconds = parts == 3 ? 3600 * (part[0] + (afternoon  ? 12
                                               : midnight ? -12
                                                          : 0)) +
                                60 * part[1] + part[2] + fraction
                          : 60 * part[0] + part[1] + fraction;
    *seconds += date;
    return true;
}

/* ---- which separator and which decimal sign ---- */

/* Whether a field is a number in some format: digits, signs and separators, perhaps with a unit. */
static bool like_number(const char *field, char separator) {
    static const import_dialect some[] = {{';', '.', ','}, {';', ',', '.'}, {';', '.', ' '}, {';', ',', ' '}};
    double x;
    bool dated;
    for (size_t k = 0; k < (separator == ' ' ? 2 : 4); k++)
        if (import_number(field, &some[k], &x))
            return true;
    return import_clock(field, &x, &dated);
}

static size_t split_copy(const char *line, char separator, char *scratch, char *fields[IMPORT_COLUMNS]) {
    return import_split(strcpy(scratch, line), separator, fields);
}

/* Numbers in a row of a line by a separator; 0 = it is no row. */
static size_t row_numbers(const char *line, char separator, char *scratch, size_t *width) {
    char *fields[IMPORT_COLUMNS];
    size_t n = split_copy(line, separator, scratch, fields), numbers = 0;
    for (size_t j = 0; j < n; j++)
        numbers += like_number(fields[j], separator);
    *width = n;
    return numbers >= 2 && 2 * numbers > n ? numbers : 0;
}

/* Numbers in rows as wide as the row before, among lines spread over the file. */
static size_t score(const import_text *text, char separator, char *scratch) {
    size_t total = 0, before = 0, step = text->n / 1000 + 1;
    for (size_t i = 0; i < text->n; i += step) {
        size_t width, numbers = row_numbers(text->lines[i], separator, scratch, &width);
        total += numbers > 0 && width == before ? 2 * numbers : numbers;
        before = numbers > 0 ? width : before;
    }
    return total;
}

/* Meaning of a comma or a point, by the numbers that have it. */
typedef struct evidence {
    size_t decimal[2], thousands[2];                         /* of '.' and ',' */
    bool either[IMPORT_COLUMNS][2], without[IMPORT_COLUMNS]; /* 1,234 is ambiguous; 987 is not */
} evidence;

static void weigh(const char *field, size_t column, evidence *e) {
    static const char marks[] = ".,";
    size_t n = strspn(field, "+-0123456789.,'eE"), lead = strspn(field, "+-");
    const char *last_mark = NULL;
    if (n == 0 || (field[n] && field[n] != ' ' && field[n] != '%'))
        return;
    for (size_t i = 0; i < n; i++)
        last_mark = field[i] == '.' || field[i] == ',' ? field + i : last_mark;
    e->without[column] = e->without[column] || last_mark == NULL;
    for (size_t m = 0; m < 2; m++) {
        const char *first = memchr(field, marks[m], n);
        if (!first)
            continue;
        const char *second = memchr(first + 1, marks[m], n - (size_t)(first + 1 - field));
        size_t before = (size_t)(first - field) - lead, after = strspn(first + 1, "0123456789");
        bool follows = memchr(field, marks[1 - m], (size_t)(first - field)) != NULL;
        if (second || last_mark > first) {
            e->thousands[m]++;
        } else if (follows || after != 3 || before == 0 || before > 3 ||
                   (before == 1 && field[lead] == '0') || first[4] == 'e' || first[4] == 'E') {
            e->decimal[m]++;
        } else {
            e->either[column][m] = true;
        }
    }
}

/* Ambiguous numbers: 1,234 everywhere in a column has a decimal comma; 1,234 beside 987 has grouped
 * thousands. */
static bool groups(const evidence *e, size_t mark, bool *any) {
    for (size_t j = 0; j < IMPORT_COLUMNS; j++) {
        *any = *any || e->either[j][mark];
        if (e->either[j][mark] && e->without[j])
            return true;
    }
    return false;
}

static void decide(const evidence *e, import_dialect *d) {
    bool comma = e->decimal[1] > e->thousands[1] && e->decimal[1] >= e->decimal[0], any[2] = {false, false};
    bool points = groups(e, 0, &any[0]), commas = groups(e, 1, &any[1]);
    if (e->decimal[0] + e->decimal[1] + e->thousands[0] + e->thousands[1] == 0 && d->separator != ',')
        comma = any[1] ? !commas : points;
    if (e->thousands[0] > 0 && e->decimal[0] == 0)
        comma = true;
    d->decimal = comma ? ',' : '.';
    d->thousands = comma ? '.' : ',';
}

void import_dialect_find(const import_text *text, int chosen, char *scratch, import_dialect *dialect) {
    static const char separators[] = "\t;|, ", options[] = ",;\t ";
    size_t best = 0, step = text->n / 1000 + 1;
    evidence e = {{0}, {0}, {{false}}, {false}};
    dialect->separator = chosen >= 0 ? options[chosen] : ',';
    for (const char *c = separators; chosen < 0 && *c; c++) {
        size_t value = score(text, *c, scratch);
        if (value > best) {
            best = value;
            dialect->separator = *c;
        }
    }
    for (size_t i = 0; i < text->n; i += step) {
        char *fields[IMPORT_COLUMNS];
        size_t width;
        if (row_numbers(text->lines[i], dialect->separator, scratch, &width) == 0)
            continue;
        size_t n = split_copy(text->lines[i], dialect->separator, scratch, fields);
        for (size_t j = 0; j < n; j++)
            weigh(fields[j], j, &e);
    }
    decide(&e, dialect);
    for (size_t i = 0; i < text->n && dialect->separator != ' '; i += step) { /* "1 234,5" */
        char *fields[IMPORT_COLUMNS];
        size_t n = split_copy(text->lines[i], dialect->separator, scratch, fields);
        for (size_t j = 0; j < n; j++) {
            size_t first = strspn(fields[j], "-0123456789");
            if (first > 0 && first <= 4 && fields[j][first] == ' ' &&
                strspn(fields[j] + first + 1, "0123456789") == 3 &&
                like_number(fields[j], dialect->separator)) {
                dialect->thousands = ' ';
            }
        }
    }
}
