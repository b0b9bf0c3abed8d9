/* export.h: marks what the shared library exports; everything else is hidden. On Windows a program that links
 * the archive defines PALP_STATIC; building the library defines PALP_BUILD. Stable. */
#ifndef PALPATE_EXPORT_H
#define PALPATE_EXPORT_H

#if defined(_WIN32) && defined(PALP_BUILD)
#define PALP_API __declspec(dllexport)
#elif defined(_WIN32) && !defined(PALP_STATIC)
#define PALP_API __declspec(dllimport)
#elif defined(_WIN32)
#define PALP_API
#elif defined(__GNUC__)
#define PALP_API __attribute__((visibility("default")))
#else
#define PALP_API
#endif

#endif
