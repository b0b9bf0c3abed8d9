/* text.c: valid UTF-8, and text that a terminal shows as one line. */
#include "text.h"

#include <palpate/file.h>

/* Length of the character at p, which is not the end; 0 = invalid UTF-8. *code is its code point. */
static int decode_utf8_character(const unsigned char *p, unsigned long *code) {
    static const unsigned long least[] = {0, 0x80, 0x800, 0x10000};
    int more = *p < 0x80 ? 0 : *p < 0xC2 ? -1 : *p < 0xE0 ? 1 : *p < 0xF0 ? 2 : *p < 0xF5 ? 3 : -1;
    *code = more > 0 ? *p & (0x3Fu >> more) : *p;
    for (int i = 1; i <= more; i++) {
        if ((p[i] & 0xC0) != 0x80)
            return 0;
        *code = *code << 6 | (p[i] & 0x3Fu);
    }
    bool surrogate = *code >= 0xD800 && *code <= 0xDFFF;
    return more < 0 || *code < least[more] || *code > 0x10FFFF || surrogate ? 0 : 1 + more;
}

bool palp_text_is_utf8(const char *text) {
    unsigned long code;
    int n = 1;
    for (const unsigned char *p = (const unsigned char *)text; *p && n > 0; p += n)
        n = decode_utf8_character(p, &code);
    return n > 0;
}

/* Control characters, line and paragraph separators, and marks of writing direction. */
static bool is_control_character(unsigned long code) {
    return code < ' ' || (code >= 0x7F && code < 0xA0) || (code >= 0x2028 && code <= 0x202E) ||
           (code >= 0x2066 && code <= 0x2069);
}

char *palp_text_make_plain(char *text) {
    unsigned long code;
    for (unsigned char *p = (unsigned char *)text; p && *p;) {
        int n = decode_utf8_character(p, &code);
        bool plain = n > 0 && !is_control_character(code);
        for (int i = 0; i < (n > 0 ? n : 1); i++, p++)
            *p = plain ? *p : '?';
    }
    return text;
}
