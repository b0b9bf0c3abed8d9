/* identity.h: how an image says which kind of board it is for: palpate firmware flash reads it there. */
#ifndef IDENTITY_H
#define IDENTITY_H

#define IDENTITY_MARK "palpate board " /* before the board's name, which ends with a zero byte */
enum { IDENTITY_WITHIN = 1024 };       /* bytes from the beginning of an image */

/* Once in an image: keeps the name where the linker script puts it, behind the vectors. */
#define IDENTITY(name)                                                                                       \
    __attribute__((section(".identity"), used)) static const char identity[] = IDENTITY_MARK name;           \
    const char *hal_board_name(void) {                                                                       \
        return identity + sizeof IDENTITY_MARK - 1;                                                          \
    }

#endif
