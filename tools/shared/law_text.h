/* law_text.h: a stiffness law as text. */
#ifndef PALPATE_LAW_TEXT_H
#define PALPATE_LAW_TEXT_H

#include <palpate/law.h>

/* On standard output, one line: "  K(e) = 47.5 e^2 - 0.7 e + 8.18 N". */
void law_text_print(const palp_law *law);

#endif
