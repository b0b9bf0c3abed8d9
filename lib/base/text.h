/* text.h: what bytes are text. */
#ifndef PALP_TEXT_H
#define PALP_TEXT_H

#include <stdbool.h>

/* UTF-8 without overlong forms and surrogates, which is what Jansson takes as text. */
bool palp_text_is_utf8(const char *text);

#endif
