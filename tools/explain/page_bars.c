/* page_bars.c: forces as bars: orange as given, blue with the effects, a dashed line at the noise level. */
#include "page.h"

#include <math.h>

static void row(FILE *to, const page_bar *bar, double noise_level_N, double most) {
    char before[32], after[32];
    bool both = isfinite(bar->before) && isfinite(bar->after);
    fputs("<tr><td>", to);
    html_text(to, bar->label);
    fputs("</td>", to);
    html_bars(to, bar->before / most, bar->after / most, noise_level_N / most);
    fprintf(to, "<td class=\"t\">%s%s%s</td></tr>\n",
            isfinite(bar->before) ? page_force(bar->before, before) : "", both ? " \u2192 " : "",
            isfinite(bar->after) ? page_force(bar->after, after) : "");
}

void page_bars(FILE *to, const char *caption, size_t n, const page_bar *bar, double noise_level_N) {
    char heads[64], force[32];
    double most = noise_level_N;
    for (size_t i = 0; i < n; i++)
        most = fmax(most, fmax(bar[i].before, bar[i].after)); /* fmax passes over NAN */
    snprintf(heads, sizeof heads, "|~dashed: noise level %s|~rms", page_force(noise_level_N, force));
    fputs("<figure>", to);
    html_table(to, NULL, heads);
    for (size_t i = 0; i < n; i++)
        row(to, &bar[i], noise_level_N, most);
    html_table_end(to);
    fputs("<figcaption>", to);
    html_text(to, caption);
    fputs("</figcaption></figure>\n", to);
}
