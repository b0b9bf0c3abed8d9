/* digits.h: a number with as many digits as it deserves. */
#ifndef PALPATE_DIGITS_H
#define PALPATE_DIGITS_H

enum { DIGITS_TEXT = 40 };

/* Formats x to the second digit of its uncertainty (four digits after the point if it has none), with an
 * exponent for very small numbers: "0.4021", "1.713e-11". Returns text. */
const char *digits_text(char text[DIGITS_TEXT], double x, double uncertainty);

#endif
