/* import_text.c: a text file for palpate import: its bytes, its encoding, its lines. */
#include "import.h"
#include "shared/crc32.h"

#include <iconv.h>
#include <stdlib.h>
#include <string.h>

static const char NAME[] = "import";

/* ---- encodings: all become UTF-8 ---- */

/* Number of NUL bytes at even or odd places near the start, which show a UTF-16 text without a mark. */
static size_t nuls(const unsigned char *text, size_t size, size_t parity) {
    size_t n = 0, most = size < 4096 ? size : 4096;
    for (size_t i = parity; i < most; i += 2)
        n += text[i] == 0;
    return n;
}

/* 0 = not UTF-16, 1 = the low byte first, 2 = the high byte first. */
static int utf16_order(const unsigned char *text, size_t size) {
    if (size < 2)
        return 0;
    if ((text[0] == 0xFF && text[1] == 0xFE) || (text[0] == 0xFE && text[1] == 0xFF))
        return text[0] == 0xFF ? 1 : 2;
    size_t half = (size < 4096 ? size : 4096) / 2, even = nuls(text, size, 0), odd = nuls(text, size, 1);
    return 2 * odd > half && even == 0 ? 1 : 2 * even > half && odd == 0 ? 2 : 0;
}

static char *put_code(char *to, unsigned long code) {
    static const unsigned char lead[] = {0, 0xC0, 0xE0, 0xF0};
    int more = (code >= 0x80) + (code >= 0x800) + (code >= 0x10000); /* bytes after the first */
    *to++ = (char)(lead[more] | code >> 6 * more);
    while (more-- > 0)
        *to++ = (char)(0x80 | (code >> 6 * more & 0x3F));
    return to;
}

static char *from_utf16(const unsigned char *from, size_t size, int order, size_t *length) {
    char *text = malloc(2 * size + 4), *to = text;
    size_t low = order == 1 ? 0 : 1;
    for (size_t i = 0; text && i + 1 < size; i += 2) {
        unsigned long code = from[i + low] | (unsigned long)from[i + 1 - low] << 8;
        if (code >= 0xD800 && code < 0xDC00 && i + 3 < size) {
            unsigned long next = from[i + 2 + low] | (unsigned long)from[i + 3 - low] << 8;
            if (next >= 0xDC00 && next < 0xE000) {
                code = 0x10000 + ((code - 0xD800) << 10) + (next - 0xDC00);
                i += 2;
            }
        }
        bool alone = code >= 0xD800 && code < 0xE000;
        to = code == 0xFEFF ? to : put_code(to, alone || code == 0 ? '?' : code);
    }
    if (text) {
        *to = '\0';
        *length = (size_t)(to - text);
    }
    return text;
}

/* Length of the UTF-8 character at text; 0 = invalid. */
static size_t utf8_bytes(const unsigned char *text) {
    size_t n = *text < 0x80                              ? 1
               : (*text & 0xE0) == 0xC0 && *text >= 0xC2 ? 2
               : (*text & 0xF0) == 0xE0                  ? 3
               : (*text & 0xF8) == 0xF0                  ? 4
                                                         : 0;
    for (size_t i = 1; i < n; i++)
        if ((text[i] & 0xC0) != 0x80)
            return 0;
    if ((*text == 0xE0 && text[1] < 0xA0) || (*text == 0xED && text[1] > 0x9F) ||
        (*text == 0xF0 && text[1] < 0x90) || *text > 0xF4 || (*text == 0xF4 && text[1] > 0x8F)) {
        return 0;
    }
    return n;
}

static bool is_utf8(const char *text) {
    for (const unsigned char *at = (const unsigned char *)text; *at;) {
        size_t n = utf8_bytes(at);
        if (n == 0)
            return false;
        at += n;
    }
    return true;
}

static char *from_latin1(const char *from, size_t size, size_t *length) {
    char *text = malloc(2 * size + 1), *to = text;
    for (size_t i = 0; text && i < size; i++)
        to = put_code(to, (unsigned char)from[i]);
    if (text) {
        *to = '\0';
        *length = (size_t)(to - text);
    }
    return text;
}

/* Converts from an encoding of the C library; NULL if the bytes are not valid in it, or it is unknown. */
static char *from_encoding(const char *encoding, char *from, size_t size, size_t *length) {
    iconv_t converter = iconv_open("UTF-8", encoding);
    if (converter == (iconv_t)-1)
        return NULL;
    size_t room = 2 * size + 4; /* at most three bytes for two, and for one that is not ASCII */
    char *text = malloc(room + size + 1), *to = text;
    room += size;
    const bool done = text && iconv(converter, &from, &size, &to, &room) != (size_t)-1;
    iconv_close(converter);
    if (!done) {
        free(text);
        return NULL;
    }
    *to = '\0';
    *length = (size_t)(to - text);
    return text;
}

/* Converts Chinese or Japanese text that names a time and a depth or force; NULL if it does not. */
static char *from_east_asia(char *from, size_t size, size_t *length) {
    static const char *const encodings[] = {"GB18030", "CP932", "BIG5"};
    for (size_t i = 0; i < sizeof encodings / sizeof *encodings; i++) {
        size_t converted;
        char *text = from_encoding(encodings[i], from, size, &converted);
        if (text && import_names_in_han(text)) {
            *length = converted;
            return text;
        }
        free(text);
    }
    return NULL;
}

/* Replaces no-break blanks by blanks, apostrophes between digits by ' and the minus sign by -. */
static size_t simplify(char *text) {
    static const struct {
        const char *is;
        char between_digits, else_;
    } signs[] = {{"\xC2\xA0", '\'', ' '},
                 {"\xE2\x80\xAF", '\'', ' '},
                 {"\xE2\x80\x89", '\'', ' '},
                 {"\xE2\x80\x99", '\'', '\''},
                 {"\xE2\x88\x92", '-', '-'},
                 {"\xE3\x80\x80", ' ', ' '}, /* the wide blank, brackets and colon of Chinese and Japanese */
                 {"\xEF\xBC\x88", '(', '('},
                 {"\xEF\xBC\x89", ')', ')'},
                 {"\xEF\xBC\x9A", ':', ':'}};
    char *to = text;
    for (const char *at = text; *at;) {
        size_t n_signs = sizeof signs / sizeof signs[0], k = *at & 0x80 ? 0 : n_signs;
        while (k < n_signs && strncmp(at, signs[k].is, strlen(signs[k].is)) != 0)
            k++;
        if (k == n_signs) {
            *to++ = *at++;
            continue;
        }
        bool before = to > text && to[-1] >= '0' && to[-1] <= '9';
        at += strlen(signs[k].is);
        *to++ = before && *at >= '0' && *at <= '9' ? signs[k].between_digits : signs[k].else_;
    }
    *to = '\0';
    return (size_t)(to - text);
}

/* Removes and counts stray NUL bytes; false: there are too many for a text. */
static bool take_nuls_out(char *text, size_t *size, size_t *stray) {
    size_t kept = 0;
    for (size_t i = 0; i < *size; i++)
        if (text[i])
            text[kept++] = text[i];
    *stray = *size - kept;
    text[kept] = '\0';
    *size = kept;
    return *stray <= 1 + kept / 1000;
}

static int decode(import_text *text, size_t size) {
    int order = utf16_order((unsigned char *)text->text, size);
    size_t stray = 0;
    char *other = NULL;
    if (!order && !take_nuls_out(text->text, &size, &stray))
        return cli_failure(NAME, "%s: not a text file: export it as CSV or text", text->file);
    if (stray > 0)
        cli_warning(NAME, "%s: %zu stray NUL byte(s) left out", text->file, stray);
    if (!order && is_utf8(text->text)) {
        simplify(text->text);
        return CLI_OK;
    }
    if (order)
        other = from_utf16((unsigned char *)text->text, size, order, &size);
    else
        other = from_east_asia(text->text, size, &size);
    if (!other && !order)
        other = from_latin1(text->text, size, &size);
    if (!other)
        return cli_failure(NAME, "%s: out of memory", text->file);
    free(text->text);
    text->text = other;
    simplify(other);
    return CLI_OK;
}

static int index_lines(import_text *text, char *at) {
    size_t capacity = 0;
    while (*at) {
        char **lines = import_grow(text->lines, text->n, &capacity, sizeof *lines);
        if (!lines)
            return cli_failure(NAME, "%s: out of memory", text->file);
        text->lines = lines;
        size_t n = strcspn(at, "\r\n");
        text->lines[text->n++] = at;
        text->longest = n > text->longest ? n : text->longest;
        char end = at[n];
        at[n] = '\0';
        size_t stamp = strspn(at, "0123456789:.");
        if (stamp > 0 && strncmp(at + stamp, " -> ", 4) == 0)
            text->lines[text->n - 1] = at + stamp + 4;
        at += n + (end != '\0');
        at += end == '\r' && *at == '\n';
    }
    return CLI_OK;
}

int import_text_read(const char *file, import_text *text) {
    memset(text, 0, sizeof *text);
    text->file = file;
    palp_error error;
    if (import_hdf5_is(file)) {
        int failed = import_hdf5_read(text);
        return failed ? failed : index_lines(text, text->text);
    }
    palp_status status = palp_file_read(file, &text->text, &text->size, &error);
    if (status)
        return cli_status(NAME, status, &error);
    text->crc32 = crc32_add(0, text->text, text->size);
    size_t size = text->size;
    int code = import_sheet_read(text, &size);
    code = code ? code : decode(text, size);
    bool marked = code == CLI_OK && strncmp(text->text, "\xEF\xBB\xBF", 3) == 0;
    return code ? code : index_lines(text, text->text + (marked ? 3 : 0));
}

bool import_left_out(const import_options *o, const char *file) {
    bool leave = o->folder && !o->strict;
    if (leave)
        cli_warning(NAME, "%s: left out, as it has no table", file);
    return leave;
}

void import_text_free(import_text *text) {
    free(text->text);
    free(text->lines);
    memset(text, 0, sizeof *text);
}

char *import_line(import_text *text) {
    return text->line < text->n ? text->lines[text->line++] : NULL;
}
