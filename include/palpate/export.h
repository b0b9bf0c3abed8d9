/* export.h: marks what the shared library exports; everything else is hidden. Stable. */
#ifndef PALPATE_EXPORT_H
#define PALPATE_EXPORT_H

#if defined(__GNUC__)
#define PALP_API __attribute__((visibility("default")))
#else
#define PALP_API
#endif

#endif
