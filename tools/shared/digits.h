/* digits.h: how many digits a number deserves. */
#ifndef PALPATE_DIGITS_H
#define PALPATE_DIGITS_H

/* Digits after the point that show two digits of an uncertainty; 4 where there is none. */
int digits_after_point(double uncertainty);

#endif
