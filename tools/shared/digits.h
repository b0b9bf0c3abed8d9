/* digits.h: a number with as many digits as it deserves. */
#ifndef PALPATE_DIGITS_H
#define PALPATE_DIGITS_H

enum { DIGITS_TEXT = 40 };

/* x to the second digit of its uncertainty (where there is none, to four after the point), with a power of
 * ten where that digit is far behind the point: "0.4021", "1.713e-11". Returns text. */
const char *digits_text(char text[DIGITS_TEXT], double x, double uncertainty);

#endif
