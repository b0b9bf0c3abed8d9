/* html.c: the pieces of a page: escaped text, tables, cards, bars, figures. */
#include "html.h"

#include <ctype.h>
#include <math.h>
#include <palpate/file.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

void html_text(FILE *to, const char *text) {
    char *plain = malloc(text ? strlen(text) + 1 : 1);
    if (plain)
        palp_text_make_plain(strcpy(plain, text ? text : ""));
    for (const char *at = plain ? plain : ""; *at; at++) {
        switch (*at) {
        case '<':
            fputs("&lt;", to);
            break;
        case '>':
            fputs("&gt;", to);
            break;
        case '&':
            fputs("&amp;", to);
            break;
        case '"':
            fputs("&quot;", to);
            break;
        default:
            fputc(*at, to);
        }
    }
    free(plain);
}

static const char STYLE[] =
    "html{color:#1c2329;background:#f6f7f8;font:16px/1.5 system-ui,'Segoe UI','DejaVu "
    "Sans',Arial,sans-serif}\n"
    "body{margin:0}main{max-width:1270px;margin:0 auto;padding:24px 36px 80px;background:#fff}\n"
    "h1{font-size:1.9rem;line-height:1.2;margin:.4em 0 .1em}h2{font-size:1.35rem;margin:2.2em 0 .6em;"
    "padding-bottom:.25em;border-bottom:2px solid #dfe4e8}h3{font-size:1.05rem;margin:1.6em 0 .4em}\n"
    "p{max-width:78ch;margin:.5em 0}.about{color:#5a6772}\n"
    "nav{display:flex;flex-wrap:wrap;gap:.3em 1.3em;margin:1em 0;font-size:.92rem}a{color:#0060a0}\n"
    ".cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(210px,1fr));gap:10px;margin:1.2em 0}\n"
    ".card{border:1px solid #dfe4e8;border-radius:6px;padding:10px 14px;background:#fbfcfd}\n"
    ".card b{display:block;font-size:1.08rem;line-height:1.35;font-variant-numeric:tabular-nums}\n"
    ".card span{color:#5a6772;font-size:.86rem}\n"
    /* a shade at an edge beyond which a wide table goes on */
    ".scroll{overflow-x:auto;margin:1em 0;background:linear-gradient(90deg,#fff 24px,transparent) local,"
    "linear-gradient(270deg,#fff 24px,transparent) local,linear-gradient(90deg,#0003,transparent 12px),"
    "linear-gradient(270deg,#0003,transparent 12px)}table{border-collapse:collapse;font-size:.87rem;"
    "font-variant-numeric:tabular-nums}\n"
    "caption{text-align:left;font-weight:600;padding:.3em 0;white-space:nowrap}\n"
    "th,td{text-align:right;padding:.28em .6em;border-bottom:1px solid "
    "#e6eaed;vertical-align:top;white-space:nowrap}\n"
    "th{border-bottom:2px solid #c3ccd3;font-weight:600;vertical-align:bottom;white-space:normal}"
    "td:first-child{white-space:normal;overflow-wrap:anywhere;min-width:9em}\n"
    "th:first-child,td:first-child,.t{text-align:left}td:first-child{padding-left:0}th:first-child{padding-"
    "left:0}\n"
    "td.t:last-child{white-space:normal}tbody tr:hover{background:#f3f6f8}\n"
    ".tables{display:flex;flex-wrap:wrap;gap:0 3.5em;align-items:flex-start}\n"
    ".figures{display:grid;grid-template-columns:repeat(auto-fill,minmax(520px,1fr));gap:16px}\n"
    "figure{margin:0;border:1px solid #e6eaed;border-radius:6px;padding:6px 8px;min-width:0}\n"
    "figure svg,figure "
    "img{display:block;width:100%;height:auto}figcaption{font-size:.86rem;color:#44505a;padding:2px "
    "6px 6px}\n"
    ".warn{background:#fff6e0;border-left:4px solid #e0a000;padding:.5em 1em;margin:.8em 0}.warn "
    "ul{margin:.2em 0}\n"
    ".verdict{border-left:6px solid #0072b2;background:#eef5fa;padding:.7em 1.2em;margin:1em 0}.verdict "
    "b{font-size:1.2rem}.agrees,.explained{border-color:#009e73;background:#edf8f4}.unexplained{border-color:"
    "#d55e00;"
    "background:#fdf3ec}\n"
    "h4{font-size:.98rem;margin:1em 0 .2em}.effect{border:1px solid #dfe4e8;border-radius:6px;padding:2px "
    "16px 8px}"
    ".taken td{font-weight:600}.candidates th:first-child{min-width:210px}.candidates "
    "th:nth-child(3){min-width:60px}\n"
    "td.bar{position:relative;min-width:260px;padding:.2em 0}.bar i{display:block;height:9px;margin:2px "
    "0;min-width:1px;"
    "background:#d55e00}.bar i.after{background:#0072b2}.candidates .bar i{background:#9aa7b1}.candidates "
    ".taken .bar i{"
    "background:#0072b2}.bar u{position:absolute;top:0;bottom:0;border-left:1px dashed #1c2329}\n"
    "td.cell{padding:2px;text-align:center}.cell b{display:inline-block;width:2.9em;font-weight:400}\n"
    ".figures{align-items:start;margin:14px 0}\n"
    "code{font:.9em/1.5 ui-monospace,'DejaVu Sans Mono',monospace;background:#f3f5f7;padding:.1em .3em;"
    "border-radius:3px;overflow-wrap:anywhere}\n"
    "details{margin:1em 0}summary{cursor:pointer;color:#0060a0}\n"
    "@media print{html,main{background:#fff}main{padding:0}figure{break-inside:avoid}}\n"
    "@media(max-width:700px){main{padding:16px}.figures{grid-template-columns:minmax(0,1fr)}}\n";

void html_open(FILE *to, const char *title) {
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
          to);
    html_text(to, title);
    fprintf(to, "</title>\n<style>\n%s</style>\n</head>\n<body>\n<main>\n<h1>", STYLE);
    html_text(to, title);
    fputs("</h1>\n", to);
}

void html_close(FILE *to) {
    fputs("</main>\n</body>\n</html>\n", to);
}

void html_section(FILE *to, const char *id, const char *title) {
    fprintf(to, "<h2 id=\"%s\">%s</h2>\n", id, title);
}

/* ---- tables: cells separated by '|'; "~" in front of a cell makes it text ---- */

static void cells(FILE *to, const char *line, const char *tag) {
    const char *at = line;
    for (bool last = false; !last;) {
        size_t n = strcspn(at, "|");
        char *cell = malloc(n + 1);
        last = !at[n];
        if (cell) {
            memcpy(cell, at, n);
            cell[n] = '\0';
            bool text = cell[0] == '~';
            fprintf(to, text ? "<%s class=\"t\">" : "<%s>", tag);
            html_text(to, cell + text);
            fprintf(to, "</%s>", tag);
            free(cell);
        }
        at += n + 1;
    }
}

void html_row(FILE *to, const char *format, ...) {
    char line[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    fputs("<tr>", to);
    cells(to, line, "td");
    fputs("</tr>\n", to);
}

void html_table(FILE *to, const char *caption, const char *heads) {
    fputs("<div class=\"scroll\"><table>", to);
    if (caption) {
        fputs("<caption>", to);
        html_text(to, caption);
        fputs("</caption>", to);
    }
    fputs("<thead><tr>", to);
    cells(to, heads, "th");
    fputs("</tr></thead><tbody>\n", to);
}

void html_table_end(FILE *to) {
    fputs("</tbody></table></div>\n", to);
}

void html_card(FILE *to, const char *label, const char *format, ...) {
    char text[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    fputs("<div class=\"card\"><span>", to);
    html_text(to, label);
    fputs("</span><b>", to);
    html_text(to, text);
    fputs("</b></div>\n", to);
}

void html_number(char text[32], const json_t *value, int digits) {
    if (json_is_number(value))
        snprintf(text, 32, "%#.*g", digits, json_number_value(value));
    else
        strcpy(text, "-");
}

/* ---- bars and figures ---- */

void html_bars(FILE *to, double before, double after, double mark) {
    fputs("<td class=\"bar\">", to);
    if (isfinite(before))
        fprintf(to, "<i style=\"width:%.1f%%\"></i>", 100 * before);
    if (isfinite(after))
        fprintf(to, "<i class=\"after\" style=\"width:%.1f%%\"></i>", 100 * after);
    fprintf(to, "<u style=\"left:%.1f%%\"></u></td>", 100 * mark);
}

static bool starts(const char *at, const char *with) {
    return strncmp(at, with, strlen(with)) == 0;
}

/* An SVG in a page shares its names with all others: ids and what refers to them get a prefix. */
static void inline_svg(FILE *to, const char *svg) {
    static const char *const names[] = {" id=\"", " id='", "href=\"#", "href='#", "url(#"};
    static unsigned number;
    const char *end = strstr(svg, "</svg>");
    number++;
    for (const char *at = svg; *at && (!end || at < end + 6);) {
        size_t k = 0;
        while (k < sizeof names / sizeof names[0] && !starts(at, names[k]))
            k++;
        if (k < sizeof names / sizeof names[0]) {
            fprintf(to, "%sf%u_", names[k], number);
            at += strlen(names[k]);
        } else {
            fputc(*at++, to);
        }
    }
}

static void figure_end(FILE *to, const char *caption) {
    fputs("<figcaption>", to);
    html_text(to, caption);
    fputs("</figcaption></figure>\n", to);
}

void html_svg(FILE *to, const char *svg, const char *caption) {
    fputs("<figure>", to);
    inline_svg(to, svg);
    figure_end(to, caption);
}

void html_image(FILE *to, const char *svg, const char *caption) {
    fputs("<figure><img alt=\"\" src=\"data:image/svg+xml,", to);
    for (const char *at = svg; *at; at++) {
        bool plain = isalnum((unsigned char)*at) || strchr(" -_.,/", *at);
        fprintf(to, plain ? "%c" : "%%%02X", (unsigned char)*at);
    }
    fputs("\"/>", to);
    figure_end(to, caption);
}

void html_draw(FILE *to, const plot_figure *figure, const char *caption) {
    char *svg;
    plot_result result = plot_svg(figure, &svg);
    if (result == PLOT_OK)
        html_svg(to, svg, caption);
    else
        fprintf(to, "<p class=\"about\">A figure is missing here: %s.</p>\n",
                result == PLOT_NO_GNUPLOT ? "gnuplot is not installed" : "gnuplot failed");
    free(svg);
}
