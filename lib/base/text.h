/* text.h: whether a text is valid UTF-8. */
#ifndef PALP_TEXT_H
#define PALP_TEXT_H

#include <stdbool.h>

/* Is it UTF-8 without overlong forms and surrogates, as Jansson requires? */
bool palp_text_is_utf8(const char *text);

#endif
