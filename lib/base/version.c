/* version.c: the library's version. */
#include <palpate/version.h>

const char *palp_version(void) {
    return PALP_VERSION;
}
