/* status.c: names and texts of the status codes. */
#include <palpate/status.h>

const char *palp_status_text(palp_status status) {
    switch (status) {
#define STATUS_TEXT(name, text)                                                                              \
    case PALP_##name:                                                                                        \
        return text;
        PALP_STATUS_LIST(STATUS_TEXT)
#undef STATUS_TEXT
    case PALP_STATUS_COUNT:
        break;
    }
    return "unknown status";
}

const char *palp_status_name(palp_status status) {
    switch (status) {
#define STATUS_NAME(name, text)                                                                              \
    case PALP_##name:                                                                                        \
        return "PALP_" #name;
        PALP_STATUS_LIST(STATUS_NAME)
#undef STATUS_NAME
    case PALP_STATUS_COUNT:
        break;
    }
    return "unknown status";
}
