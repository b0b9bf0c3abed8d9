/* import_words.c: the words of eight languages by which columns and specimens are named, and units. */
#include "import.h"

#include <ctype.h>
#include <string.h>

/* ---- units: to s, mm, N, Pa, 1, V, mm2, N/m, mm/V, Hz ---- */

/* clang-format off */
static const import_unit units[] = {
    {UNIT_TIME, "s", 1}, {UNIT_TIME, "ms", 1e-3}, {UNIT_TIME, "min", 60}, {UNIT_TIME, "sec", 1},
    {UNIT_TIME, "us", 1e-6}, {UNIT_TIME, "ns", 1e-9}, {UNIT_TIME, "h", 3600}, {UNIT_TIME, "hr", 3600},
    {UNIT_TIME, "secs", 1}, {UNIT_TIME, "second", 1}, {UNIT_TIME, "seconds", 1}, {UNIT_TIME, "sek", 1},
    {UNIT_TIME, "secondes", 1}, {UNIT_TIME, "secondi", 1}, {UNIT_TIME, "segundos", 1},
    {UNIT_TIME, "sekunden", 1}, {UNIT_TIME, "msec", 1e-3}, {UNIT_TIME, "minutes", 60},
    {UNIT_TIME, "mins", 60}, {UNIT_TIME, "hh:mm:ss", 1}, {UNIT_LENGTH, "mm", 1},
    {UNIT_LENGTH, "um", 1e-3}, {UNIT_LENGTH, "cm", 10}, {UNIT_LENGTH, "m", 1e3},
    {UNIT_LENGTH, "in", 25.4}, {UNIT_LENGTH, "nm", 1e-6}, {UNIT_LENGTH, "pm", 1e-9},
    {UNIT_LENGTH, "inch", 25.4}, {UNIT_LENGTH, "inches", 25.4}, {UNIT_LENGTH, "mil", 0.0254},
    {UNIT_LENGTH, "micron", 1e-3}, {UNIT_LENGTH, "microns", 1e-3}, {UNIT_FORCE, "N", 1},
    {UNIT_FORCE, "mN", 1e-3}, {UNIT_FORCE, "kN", 1e3}, {UNIT_FORCE, "gf", 9.80665e-3},
    {UNIT_FORCE, "kgf", 9.80665}, {UNIT_FORCE, "lbf", 4.4482216152605}, {UNIT_FORCE, "uN", 1e-6},
    {UNIT_FORCE, "nN", 1e-9}, {UNIT_FORCE, "pN", 1e-12}, {UNIT_FORCE, "MN", 1e6}, {UNIT_FORCE, "daN", 10},
    {UNIT_FORCE, "cN", 1e-2}, {UNIT_FORCE, "g", 9.80665e-3}, {UNIT_FORCE, "kg", 9.80665},
    {UNIT_FORCE, "lb", 4.4482216152605}, {UNIT_FORCE, "lbs", 4.4482216152605},
    {UNIT_FORCE, "mg", 9.80665e-6}, {UNIT_FORCE, "kp", 9.80665}, {UNIT_FORCE, "dyn", 1e-5},
    {UNIT_FORCE, "ozf", 0.27801385095378125}, {UNIT_FORCE, "newton", 1}, {UNIT_FORCE, "newtons", 1},
    {UNIT_STRESS, "Pa", 1}, {UNIT_STRESS, "kPa", 1e3}, {UNIT_STRESS, "MPa", 1e6},
    {UNIT_STRESS, "GPa", 1e9}, {UNIT_STRESS, "mPa", 1e-3}, {UNIT_STRESS, "N/mm2", 1e6},
    {UNIT_STRESS, "N/m2", 1}, {UNIT_STRESS, "N/cm2", 1e4}, {UNIT_STRESS, "psi", 6894.757293168},
    {UNIT_STRESS, "bar", 1e5}, {UNIT_STRESS, "mmHg", 133.322387415}, {UNIT_STRESS, "kN/m2", 1e3},
    {UNIT_STRESS, "N/mm^2", 1e6}, {UNIT_STRESS, "N/m^2", 1}, {UNIT_STRESS, "hPa", 100},
    {UNIT_STRESS, "ksi", 6894757.293168}, {UNIT_RATIO, "%", 1e-2}, {UNIT_RATIO, "-", 1},
    {UNIT_RATIO, "1", 1}, {UNIT_RATIO, "mm/mm", 1}, {UNIT_RATIO, "m/m", 1}, {UNIT_RATIO, "in/in", 1},
    {UNIT_RATIO, "percent", 1e-2}, {UNIT_RATIO, "strain", 1}, {UNIT_RATIO, "stretch", 1},
    {UNIT_RATIO, "ratio", 1}, {UNIT_RATIO, "um/m", 1e-6}, {UNIT_RATIO, "prozent", 1e-2},
    {UNIT_VOLT, "V", 1}, {UNIT_VOLT, "mV", 1e-3}, {UNIT_VOLT, "volt", 1}, {UNIT_VOLT, "volts", 1},
    {UNIT_AREA, "mm2", 1}, {UNIT_AREA, "cm2", 100}, {UNIT_AREA, "m2", 1e6}, {UNIT_AREA, "mm^2", 1},
    {UNIT_AREA, "cm^2", 100}, {UNIT_AREA, "m^2", 1e6}, {UNIT_AREA, "in2", 645.16},
    {UNIT_AREA, "in^2", 645.16}, {UNIT_SPRING, "N/m", 1}, {UNIT_SPRING, "mN/m", 1e-3},
    {UNIT_SPRING, "pN/nm", 1e-3}, {UNIT_SPRING, "nN/nm", 1}, {UNIT_SPRING, "N/mm", 1e3},
    {UNIT_SLOPE, "m/V", 1e3}, {UNIT_SLOPE, "nm/V", 1e-6}, {UNIT_SLOPE, "um/V", 1e-3},
    {UNIT_RATE, "Hz", 1}, {UNIT_OTHER, "mm/s", 1}, {UNIT_OTHER, "mm/min", 1}, {UNIT_OTHER, "N/s", 1},
    {UNIT_OTHER, "C", 1}, {UNIT_OTHER, "K", 1}, {UNIT_OTHER, "%/s", 1}, {UNIT_OTHER, "%/min", 1},
    {UNIT_OTHER, "J", 1}, {UNIT_OTHER, "mJ", 1}, {UNIT_OTHER, "um/s", 1}, {UNIT_OTHER, "rad", 1},
    {UNIT_RATE, "1/s", 1}, {UNIT_OTHER, "deg", 1}, {UNIT_OTHER, "A", 1}, {UNIT_OTHER, "Nm", 1},
    {UNIT_OTHER, "mm3", 1}, {UNIT_OTHER, "Pa.s", 1}, {UNIT_OTHER, "N/min", 1}, {UNIT_OTHER, "kN/mm", 1},
    {UNIT_RATE, "kHz", 1e3}, {UNIT_RATE, "S/s", 1}, {UNIT_RATE, "pts/s", 1}, {UNIT_RATE, "pts/sec", 1},
    {UNIT_RATE, "pts/secs", 1}, {UNIT_RATE, "samples/s", 1}, {UNIT_RATE, "1/sec", 1},
    {UNIT_RATE, "samples/sec", 1}, {UNIT_LENGTH, "millimeters", 1}, {UNIT_LENGTH, "millimeter", 1},
    {UNIT_LENGTH, "millimetres", 1}, {UNIT_LENGTH, "meters", 1e3}, {UNIT_LENGTH, "micrometers", 1e-3},
    {UNIT_LENGTH, "micrometer", 1e-3}, {UNIT_FORCE, "millinewtons", 1e-3}, {UNIT_STRESS, "pascal", 1},
    {UNIT_TIME, "秒", 1}, {UNIT_TIME, "毫秒", 1e-3}, {UNIT_TIME, "分", 60}, {UNIT_LENGTH, "毫米", 1},
    {UNIT_LENGTH, "微米", 1e-3}, {UNIT_LENGTH, "厘米", 10}, {UNIT_FORCE, "牛", 1},
    {UNIT_FORCE, "牛顿", 1},
    {UNIT_FORCE, "毫牛", 1e-3}, {UNIT_FORCE, "千牛", 1e3}, {UNIT_FORCE, "克", 9.80665e-3},
    {UNIT_FORCE, "千克", 9.80665}, {UNIT_STRESS, "千帕", 1e3}, {UNIT_STRESS, "兆帕", 1e6}};
/* clang-format on */

enum { N_UNITS = sizeof units / sizeof units[0] };

/* First byte of a Chinese or Japanese character of three, U+3000 to U+9FFF. */
static bool starts_han(unsigned char c) {
    return c >= 0xE3 && c <= 0xE9;
}

/* Simplifies UTF-8: letters lose their accents, micro becomes u and squared 2. Chinese and Japanese
 * characters stay, other signs are removed. */
void import_plain(const char *from, bool lower, char *to, size_t room) {
    static const char plain[] = "AAAAAAACEEEEIIIIDNOOOOOxOUUUUYPsaaaaaaaceeeeiiiidnooooo/ouuuuypy";
    size_t n = 0;
    for (const unsigned char *at = (const unsigned char *)from; *at && n + 1 < room; at++) {
        unsigned char c = *at;
        if (c == 0xC3 && at[1] >= 0x80 && at[1] <= 0xBF) {
            c = (unsigned char)plain[*++at - 0x80];
        } else if ((c == 0xC2 && at[1] == 0xB5) || (c == 0xCE && at[1] == 0xBC)) {
            c = 'u';
            at++;
        } else if (c == 0xC2 && (at[1] == 0xB2 || at[1] == 0xB3)) {
            c = at[1] == 0xB2 ? '2' : '3';
            at++;
        } else if (starts_han(c) && at[1] && at[2]) {
            for (int i = 0; i < 2 && n + 3 < room; i++)
                to[n++] = (char)*at++;
            c = *at;
        } else if (c >= 0x80) {
            continue;
        }
        to[n++] = (char)(lower ? tolower(c) : c);
    }
    to[n] = '\0';
}

static bool same_letters(const char *a, const char *b) {
    while (*a && tolower((unsigned char)*a) == tolower((unsigned char)*b)) {
        a++;
        b++;
    }
    return !*a && !*b;
}

/* Finds a unit as written; if longer than one letter, also in other case. */
const import_unit *import_unit_find(const char *name) {
    char plain[IMPORT_WORD];
    name += strspn(name, " ");
    import_plain(name, false, plain, sizeof plain);
    size_t n = strlen(plain);
    while (n > 0 && (plain[n - 1] == ' ' || plain[n - 1] == '.'))
        plain[--n] = '\0';
    const import_unit *other = NULL;
    for (size_t i = 0; i < N_UNITS; i++) {
        if (!same_letters(units[i].name, plain))
            continue;
        if (strcmp(units[i].name, plain) == 0)
            return &units[i];
        other = other || n == 1 ? other : &units[i];
    }
    return other;
}

bool import_unit_any(const char *name) {
    return import_unit_find(name) != NULL;
}

/* The last unit in brackets; else the longest end of the name that is a unit: "Position (z), mm", "force_N".
 */
const import_unit *import_unit_of_name(const char *name) {
    static const char opening[] = "([{", closing[] = ")]}", breaks[] = " ,/_|";
    char text[IMPORT_WORD];
    const import_unit *found = NULL;
    for (const char *at = name; *at; at++) {
        const char *open = strchr(opening, *at), *end = open ? strchr(at, closing[open - opening]) : NULL;
        size_t n = end ? (size_t)(end - at) - 1 : 0;
        if (end && n < sizeof text) {
            memcpy(text, at + 1, n);
            text[n] = '\0';
            const import_unit *unit = import_unit_find(text);
            found = unit ? unit : found;
        }
    }
    for (const char *at = name; !found && *at; at++)
        if (strchr(breaks, *at) && at > name && at[1 + strspn(at + 1, " ")])
            found = import_unit_find(at + 1);
    return found;
}

/* Words are between bars. A word also matches within a longer one, but "=t" is a whole word. The rank is the
 * certainty of a name with one of them. */
static const struct ranked {
    int role, rank;
    const char *list;
    /* clang-format off */
} words[] = {
    {TIME, 3, "time|zeit|=temps|=tempo|tiempo|elapsed|时间|時間"},
    {TIME, 2, "=t|uhr|clock|=hora|=heure|=ora|=date|=datum|x_value"},
    {DEPTH, 4, "depth|indent|eindring|enfoncement|penetra|affondamento|profon|profun|tipposition|"
        "tip position|深度|深さ"},
    {DEPTH, 3, "displac|=disp|compress|position|posicion|posizione|posicao|=pos|extension|extensom|"
        "travel|stroke|crosshead|weg|verschiebung|deplacement|spostamento|desplaz|desloc|traverse|"
        "verformung|stauchung|course|corsa|carrera|=curso|hub|allongement|allungamento|alargamiento|"
        "alongamento|deform|recorrido|ecrasement|lvdt|percurso|"
        "schiacciamento|位移|変位|變位|变形|變形|"
        "変形|行程|位置|ストローク"},
    {DEPTH, 2, "height|hauteur|altezza|altura|hohe|=gap|spalt|distan|abstand|deflection|piezo|=z|=d|=x|"
        "=s|=u|=h|=l|=dl|delta|path|length|距离|距離"},
    {FORCE, 3, "force|load|kraft|forza|fuerza|forca|=carga|=carico|=charge|=effort|=last|=fz|=fn|=力|"
        "力值|试验力|試驗力|試験力|载荷|載荷|负荷|荷重|压力|圧力"},
    {FORCE, 2, "=f|weight|gewicht|=poids|=peso|=tension|deflection"},
    {STRESS, 3, "stress|spannung|contrainte|sforzo|tension|esfuerzo|tensao|应力|應力|応力"},
    {STRESS, 2, "pressure|sigma|=f|压力|圧力"},
    {STRAIN, 3, "strain|dehnung|deform|stauchung|stretch|应变|應變|ひずみ"},
    {STRAIN, 2, "epsilon|compress|elongation|extension|lambda|allongement|=l|allungamento|alargamiento|"
        "alongamento"},
    {DEFLECTION, 3, "deflection|auslenkung|deflexion"}};
/* clang-format on */

/* Names with these are of something else, or are rather not the one. */
static const char never[] =
    "rate|speed|velocity|geschwindigkeit|vitesse|velocita|velocidad|velocidade|"
    "tempera|frequen|freq|stiffness|modul|steifigkeit|energ|work|arbeit|=error|zyklus|friction|速度|速率|"
    "温度";
static const char rather_not[] =
    "target|=set|setpoint|soll|demand|consigne|command|true|wahre|=vraie|"
    "lateral|transverse|horizontal|quer|peak|=max|=min|average|raw|corrected|preload|absolut";

static bool is_letter(char c) {
    return isalnum((unsigned char)c) || (unsigned char)c >= 0x80;
}

/* Where the first n letters of a word are in a text; NULL: nowhere. */
static const char *find(const char *text, const char *word, size_t n) {
    while (*text && strncmp(text, word, n) != 0)
        text++;
    return *text ? text : NULL;
}

/* Whether a name in small plain letters has the word of n letters. */
static bool has_word(const char *name, const char *word, size_t n) {
    const bool whole = *word == '=';
    word += whole;
    n -= whole;
    for (const char *at = find(name, word, n); at; at = find(at + 1, word, n)) {
        bool starts = at == name || !is_letter(at[-1]), ends = !is_letter(at[n]);
        if (!whole || (starts && ends))
            return true;
    }
    return false;
}

static bool has_any(const char *name, const char *list) {
    for (size_t n; *list; list += n + (list[n] == '|')) {
        n = strcspn(list, "|");
        if (has_word(name, list, n))
            return true;
    }
    return false;
}

static import_dimension wanted(int role) {
    static const import_dimension of[ROLES] = {UNIT_TIME,   UNIT_LENGTH, UNIT_FORCE,
                                               UNIT_STRESS, UNIT_RATIO,  UNIT_LENGTH};
    return of[role];
}

bool import_unit_fits(const import_unit *unit, int role) {
    return unit->dimension == wanted(role) || (role == DEFLECTION && unit->dimension == UNIT_VOLT);
}

int import_name_rank(const char *name, const import_unit *unit, int role) {
    char plain[IMPORT_WORD];
    int rank = unit && import_unit_fits(unit, role) && role < STRESS && unit->dimension != UNIT_RATIO ? 1 : 0;
    import_plain(name, true, plain, sizeof plain);
    if (unit && !import_unit_fits(unit, role))
        return 0;
    if (has_any(plain, never) && !(role == TIME && has_any(plain, "time")))
        return 0;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (words[i].role == role && words[i].rank > rank && has_any(plain, words[i].list))
            rank = words[i].rank;
    return rank > 1 && has_any(plain, rather_not) ? 1 : rank;
}

bool import_names_in_han(const char *text) {
    bool found[ROLES] = {false};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        const char *at = words[i].list;
        for (size_t n; *at; at += n + (at[n] == '|')) {
            const size_t whole = *at == '=';
            n = strcspn(at, "|");
            if (starts_han((unsigned char)at[whole]) && find(text, at + whole, n - whole))
                found[words[i].role] = true;
        }
    }
    return found[TIME] + found[DEPTH] + found[FORCE] + found[STRESS] + found[STRAIN] >= 2;
}

bool import_names_gap(const char *name) {
    char plain[IMPORT_WORD];
    import_plain(name, true, plain, sizeof plain);
    return has_any(plain, "gap|spalt|entrefer|currentsize|current size|size_");
}

/* clang-format off */
static const struct ranked parts[] = {
    {PART_HEIGHT, 4, "height|hohe|hauteur|altezza|altura|高度|高さ"},
    {PART_HEIGHT, 3, "length|lange|longueur|lunghezza|longitud|comprimento"},
    {PART_HEIGHT, 2, "gap|spalt|entrefer|thickness|dicke|epaisseur|spessore|espesor|espessura|=h0|=l0|"
        "厚度|厚さ"},
    {PART_DIAMETER, 3, "diamet|durchmesser|=d0|直径|直徑"},
    {PART_RADIUS, 3, "radius|=rayon|=raggio|=radio|=raio|半径|半徑"},
    {PART_AREA, 3, "=area|flache|querschnitt|=section|=aire|=seccion|sezione|面积|面積"},
    {PART_AREA, 2, "=a0|=s0"},
    {PART_SPRING, 3, "springconstant|spring constant|spring_constant|federkonstante"},
    {PART_SENSITIVITY, 3, "=sensitivity|invols"},
    {PART_RATE, 3, "sampling rate|sample rate|data rate|acquisition rate|sampling frequency|"
        "sample frequency|abtastrate|abtastfrequenz|messrate|frequence d'echantillonnage|"
        "frequenza di campionamento|frecuencia de muestreo|frequencia de amostragem"},
    {PART_RATE, 2, "samplerate|sample_rate|sampling_rate"},
    {PART_INTERVAL, 3, "sampling interval|sample interval|sampling time|delta_x|abtastintervall"},
    {PART_INTERVAL, 2, "=dt"},
    {PART_TIP_RADIUS, 3, "tip radius|tip_radius|indenter radius|probe radius|punch radius|kugelradius"},
    {PART_TIP_DIAMETER, 3, "tip diameter|indenter diameter|probe diameter|punch diameter|"
        "kugeldurchmesser|stempeldurchmesser"}};
/* clang-format on */

/* A length of these is none of the specimen, nor a spring constant. */
static const char elsewhere[] =
    "probe diam|indent|punch|=tip|tip_|plate|platte|stempel|anvil|limit|"
    "offset|=max|=min|final|wave|scan|path|loading|field|cable|step|multiplier|cantilever|buffer|k-length|"
    "file|=data|at break|record|sensor|setpoint|sample rate|=rate|after|=end|trigger";

int import_part_rank(const char *name, int part) {
    char plain[IMPORT_WORD];
    int rank = 0;
    import_plain(name, true, plain, sizeof plain);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if (parts[i].role == part && parts[i].rank > rank && has_any(plain, parts[i].list))
            rank = parts[i].rank;
    return part < PART_RATE && has_any(plain, elsewhere) ? 0 : rank;
}
