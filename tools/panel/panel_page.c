/* panel_page.c: the page, put together from page.html, page.css and page.js, which make writes into
 * page_bytes.h. */
#include "panel.h"

#include "page_bytes.h"

#include <stdlib.h>
#include <string.h>

static char *put(char *to, const unsigned char *from, size_t n) {
    memcpy(to, from, n);
    return to + n;
}

char *panel_page(size_t *n) {
    static const char style[] = "<style>\n", script[] = "</style>\n<script>\n", end[] = "</script>\n";
    *n = sizeof page_html + sizeof page_css + sizeof page_js + sizeof style + sizeof script + sizeof end - 3;
    char *page = malloc(*n + 1), *at = page;
    if (!page)
        return NULL;
    at = put(at, page_html, sizeof page_html);
    at = put(at, (const unsigned char *)style, sizeof style - 1);
    at = put(at, page_css, sizeof page_css);
    at = put(at, (const unsigned char *)script, sizeof script - 1);
    at = put(at, page_js, sizeof page_js);
    put(at, (const unsigned char *)end, sizeof end - 1);
    return page;
}
