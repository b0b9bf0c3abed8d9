/* import_tip.c: what pressed, by the options or the file's settings: a plate, flat punch, sphere or cone. */
#include "import.h"

#include <palpate/indentation.h>
#include <string.h>

static const char *const holders[] = {"tip", "indenter", "probe", "punch", "eindring", "penetrat"};
static const struct kind_word {
    palp_tip_kind kind;
    const char *text;
} kinds[] = {{PALP_TIP_SPHERE, "spher"}, {PALP_TIP_SPHERE, "ball"},  {PALP_TIP_SPHERE, "kugel"},
             {PALP_TIP_SPHERE, "bead"},  {PALP_TIP_SPHERE, "sfer"},  {PALP_TIP_SPHERE, "esfer"},
             {PALP_TIP_FLAT, "flat"},    {PALP_TIP_FLAT, "cylind"},  {PALP_TIP_FLAT, "zylind"},
             {PALP_TIP_CONE, "cone"},    {PALP_TIP_CONE, "conical"}, {PALP_TIP_CONE, "kegel"}};

static bool is_of_tip(const char *plain) {
    for (size_t k = 0; k < sizeof holders / sizeof *holders; k++)
        if (strstr(plain, holders[k]))
            return true;
    return false;
}

/* "Indenter: Spherical" */
static bool kind_of_file(const import_source *s, palp_tip_kind *kind) {
    for (size_t i = 0; i < s->n_settings; i++) {
        char key[IMPORT_WORD], value[IMPORT_WORD];
        import_plain(s->setting[i][0], true, key, sizeof key);
        import_plain(s->setting[i][1], true, value, sizeof value);
        for (size_t k = 0; is_of_tip(key) && k < sizeof kinds / sizeof *kinds; k++) {
            if (strstr(value, kinds[k].text)) {
                *kind = kinds[k].kind;
                return true;
            }
        }
    }
    return false;
}

/* Takes the shape from the file only with its size. */
void import_tip(const import_options *o, import_source *s) {
    const char *key;
    palp_tip_kind kind;
    double diameter = import_part(s, PART_TIP_DIAMETER, &key), radius = import_part(s, PART_TIP_RADIUS, &key);
    s->tip_radius_mm = o->tip_radius_mm > 0 ? o->tip_radius_mm : radius > 0 ? radius : diameter / 2;
    s->tip_angle_deg = o->tip_angle_deg;
    if (o->tip >= 0)
        s->tip = palp_tip_name((palp_tip_kind)o->tip);
    else if (kind_of_file(s, &kind) && (kind == PALP_TIP_CONE ? s->tip_angle_deg : s->tip_radius_mm) > 0)
        s->tip = palp_tip_name(kind);
}
