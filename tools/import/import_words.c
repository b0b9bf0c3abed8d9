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

/* UTF-8 without accents: letters of Latin-1 become plain ones, micro u, squared 2; Chinese and Japanese ones
 * stay, other signs are left out. */
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

/* As it is written; else, where it is longer than one letter, in capitals or not. */
const import_unit *import_unit_find(const char *name) {
    char plain[IMPORT_WORD];
    name += strspn(name, " ");
    import_plain(name, false, plain, sizeof plain);
    size_t n = strlen(plain);
    while (n > 0 && (plain[n - 1] == ' ' || plain[n - 1] == '.'))
        plain[--n] = '\0';
    for (size_t i = 0; i < N_UNITS; i++)
        if (strcmp(units[i].name, plain) == 0)
            return &units[i];
    for (size_t i = 0; n > 1 && i < N_UNITS; i++)
        if (same_letters(units[i].name, plain))
            return &units[i];
    return NULL;
}

bool import_unit_any(const char *name) {
    return import_unit_find(name) != NULL;
}

/* A unit in brackets, the last of them; else the longest end of the name that is a unit: "Position (z), mm",
 * "force_N". */
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

/* ---- what a name says ---- */

/* A word stands for itself in a longer one, but "=t" is all of a word. The rank says how surely it is the
 * one. */
static const struct word {
    int role, rank;
    const char *text;
    /* clang-format off */
} words[] = {
    {TIME, 3, "time"}, {TIME, 3, "zeit"}, {TIME, 3, "=temps"}, {TIME, 3, "=tempo"}, {TIME, 3, "tiempo"},
    {TIME, 3, "elapsed"}, {TIME, 2, "=t"}, {TIME, 2, "uhr"}, {TIME, 2, "clock"}, {TIME, 2, "=hora"},
    {TIME, 2, "=heure"}, {TIME, 2, "=ora"}, {TIME, 2, "=date"}, {TIME, 2, "=datum"}, {TIME, 2, "x_value"},
    {DEPTH, 4, "depth"}, {DEPTH, 4, "indent"}, {DEPTH, 4, "eindring"}, {DEPTH, 4, "enfoncement"},
    {DEPTH, 4, "penetra"}, {DEPTH, 4, "affondamento"}, {DEPTH, 4, "profon"}, {DEPTH, 4, "profun"},
    {DEPTH, 4, "tipposition"}, {DEPTH, 4, "tip position"}, {DEPTH, 3, "displac"}, {DEPTH, 3, "=disp"},
    {DEPTH, 3, "compress"}, {DEPTH, 3, "position"}, {DEPTH, 3, "posicion"}, {DEPTH, 3, "posizione"},
    {DEPTH, 3, "posicao"}, {DEPTH, 3, "=pos"}, {DEPTH, 3, "extension"}, {DEPTH, 3, "extensom"},
    {DEPTH, 3, "travel"}, {DEPTH, 3, "stroke"}, {DEPTH, 3, "crosshead"}, {DEPTH, 3, "weg"},
    {DEPTH, 3, "verschiebung"}, {DEPTH, 3, "deplacement"}, {DEPTH, 3, "spostamento"},
    {DEPTH, 3, "desplaz"}, {DEPTH, 3, "desloc"}, {DEPTH, 3, "traverse"}, {DEPTH, 3, "verformung"},
    {DEPTH, 3, "stauchung"}, {DEPTH, 3, "course"}, {DEPTH, 3, "corsa"}, {DEPTH, 3, "carrera"},
    {DEPTH, 3, "=curso"}, {DEPTH, 3, "hub"}, {DEPTH, 3, "allongement"}, {DEPTH, 3, "allungamento"},
    {DEPTH, 3, "alargamiento"}, {DEPTH, 3, "alongamento"}, {DEPTH, 3, "deform"}, {DEPTH, 3, "recorrido"},
    {DEPTH, 3, "ecrasement"}, {DEPTH, 3, "lvdt"}, {DEPTH, 3, "percurso"}, {DEPTH, 3, "schiacciamento"},
    {DEPTH, 2, "height"}, {DEPTH, 2, "hauteur"}, {DEPTH, 2, "altezza"}, {DEPTH, 2, "altura"},
    {DEPTH, 2, "hohe"}, {DEPTH, 2, "=gap"}, {DEPTH, 2, "spalt"}, {DEPTH, 2, "distan"},
    {DEPTH, 2, "abstand"}, {DEPTH, 2, "deflection"}, {DEPTH, 2, "piezo"}, {DEPTH, 2, "=z"},
    {DEPTH, 2, "=d"}, {DEPTH, 2, "=x"}, {DEPTH, 2, "=s"}, {DEPTH, 2, "=u"}, {DEPTH, 2, "=h"},
    {DEPTH, 2, "=l"}, {DEPTH, 2, "=dl"}, {DEPTH, 2, "delta"}, {DEPTH, 2, "path"}, {DEPTH, 2, "length"},
    {FORCE, 3, "force"}, {FORCE, 3, "load"}, {FORCE, 3, "kraft"}, {FORCE, 3, "forza"},
    {FORCE, 3, "fuerza"}, {FORCE, 3, "forca"}, {FORCE, 3, "=carga"}, {FORCE, 3, "=carico"},
    {FORCE, 3, "=charge"}, {FORCE, 3, "=effort"}, {FORCE, 3, "=last"}, {FORCE, 3, "=fz"},
    {FORCE, 3, "=fn"}, {FORCE, 2, "=f"}, {FORCE, 2, "weight"}, {FORCE, 2, "gewicht"},
    {FORCE, 2, "=poids"}, {FORCE, 2, "=peso"}, {FORCE, 2, "=tension"}, {FORCE, 2, "deflection"},
    {STRESS, 3, "stress"}, {STRESS, 3, "spannung"}, {STRESS, 3, "contrainte"}, {STRESS, 3, "sforzo"},
    {STRESS, 3, "tension"}, {STRESS, 3, "esfuerzo"}, {STRESS, 3, "tensao"}, {STRESS, 2, "pressure"},
    {STRESS, 2, "sigma"}, {STRESS, 2, "=f"}, {STRAIN, 3, "strain"}, {STRAIN, 3, "dehnung"},
    {STRAIN, 3, "deform"}, {STRAIN, 3, "stauchung"}, {STRAIN, 3, "stretch"}, {STRAIN, 2, "epsilon"},
    {STRAIN, 2, "compress"}, {STRAIN, 2, "elongation"}, {STRAIN, 2, "extension"}, {STRAIN, 2, "lambda"},
    {STRAIN, 2, "allongement"}, {STRAIN, 2, "=l"}, {STRAIN, 2, "allungamento"},
    {STRAIN, 2, "alargamiento"}, {STRAIN, 2, "alongamento"}, {DEFLECTION, 3, "deflection"},
    {DEFLECTION, 3, "auslenkung"}, {DEFLECTION, 3, "deflexion"}, {TIME, 3, "时间"}, {TIME, 3, "時間"},
    {DEPTH, 4, "深度"}, {DEPTH, 4, "深さ"}, {DEPTH, 3, "位移"}, {DEPTH, 3, "変位"},
    {DEPTH, 3, "變位"},
    {DEPTH, 3, "变形"}, {DEPTH, 3, "變形"}, {DEPTH, 3, "変形"}, {DEPTH, 3, "行程"},
    {DEPTH, 3, "位置"},
    {DEPTH, 3, "ストローク"}, {DEPTH, 2, "距离"}, {DEPTH, 2, "距離"}, {FORCE, 3, "=力"},
    {FORCE, 3, "力值"},
    {FORCE, 3, "试验力"}, {FORCE, 3, "試驗力"}, {FORCE, 3, "試験力"}, {FORCE, 3, "载荷"},
    {FORCE, 3, "載荷"},
    {FORCE, 3, "负荷"}, {FORCE, 3, "荷重"}, {FORCE, 3, "压力"}, {FORCE, 3, "圧力"},
    {STRESS, 3, "应力"},
    {STRESS, 3, "應力"}, {STRESS, 3, "応力"}, {STRESS, 2, "压力"}, {STRESS, 2, "圧力"},
    {STRAIN, 3, "应变"},
    {STRAIN, 3, "應變"}, {STRAIN, 3, "ひずみ"}};
/* clang-format on */

/* Names with these are of something else, or are rather not the one. */
static const char *const never[] = {
    "rate",    "speed",   "velocity", "geschwindigkeit", "vitesse", "velocita",    "velocidad", "velocidade",
    "tempera", "frequen", "freq",     "stiffness",       "modul",   "steifigkeit", "energ",     "work",
    "arbeit",  "=error",  "zyklus",   "friction",        "速度",    "速率",        "温度"};
static const char *const rather_not[] = {
    "target", "=set",    "setpoint", "soll",       "demand",     "consigne", "command", "true",
    "wahre",  "=vraie",  "lateral",  "transverse", "horizontal", "quer",     "peak",    "=max",
    "=min",   "average", "raw",      "corrected",  "preload",    "absolut"};

static bool is_letter(char c) {
    return isalnum((unsigned char)c) || (unsigned char)c >= 0x80;
}

/* Whether a name in small plain letters has the word. */
static bool has_word(const char *name, const char *word) {
    bool whole = *word == '=';
    word += whole;
    size_t n = strlen(word);
    for (const char *at = strstr(name, word); at; at = strstr(at + 1, word)) {
        bool starts = at == name || !is_letter(at[-1]), ends = !is_letter(at[n]);
        if (!whole || (starts && ends))
            return true;
    }
    return false;
}

static bool has_any(const char *name, size_t n, const char *const list[]) {
    for (size_t i = 0; i < n; i++)
        if (has_word(name, list[i]))
            return true;
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
    if (has_any(plain, sizeof never / sizeof *never, never) && !(role == TIME && has_word(plain, "time")))
        return 0;
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (words[i].role == role && words[i].rank > rank && has_word(plain, words[i].text))
            rank = words[i].rank;
    return rank > 1 && has_any(plain, sizeof rather_not / sizeof *rather_not, rather_not) ? 1 : rank;
}

bool import_names_in_han(const char *text) {
    bool found[ROLES] = {false};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        const char *word = words[i].text + (*words[i].text == '=');
        if (starts_han((unsigned char)*word) && strstr(text, word))
            found[words[i].role] = true;
    }
    return found[TIME] + found[DEPTH] + found[FORCE] + found[STRESS] + found[STRAIN] >= 2;
}

bool import_names_gap(const char *name) {
    static const char *const gaps[] = {"gap", "spalt", "entrefer", "currentsize", "current size", "size_"};
    char plain[IMPORT_WORD];
    import_plain(name, true, plain, sizeof plain);
    return has_any(plain, sizeof gaps / sizeof *gaps, gaps);
}

/* ---- the specimen and the instrument ---- */

/* clang-format off */
static const struct word parts[] = {
    {PART_HEIGHT, 4, "height"}, {PART_HEIGHT, 4, "hohe"}, {PART_HEIGHT, 4, "hauteur"},
    {PART_HEIGHT, 4, "altezza"}, {PART_HEIGHT, 4, "altura"}, {PART_HEIGHT, 3, "length"},
    {PART_HEIGHT, 3, "lange"}, {PART_HEIGHT, 3, "longueur"}, {PART_HEIGHT, 3, "lunghezza"},
    {PART_HEIGHT, 3, "longitud"}, {PART_HEIGHT, 3, "comprimento"}, {PART_HEIGHT, 2, "gap"},
    {PART_HEIGHT, 2, "spalt"}, {PART_HEIGHT, 2, "entrefer"}, {PART_HEIGHT, 2, "thickness"},
    {PART_HEIGHT, 2, "dicke"}, {PART_HEIGHT, 2, "epaisseur"}, {PART_HEIGHT, 2, "spessore"},
    {PART_HEIGHT, 2, "espesor"}, {PART_HEIGHT, 2, "espessura"}, {PART_HEIGHT, 2, "=h0"},
    {PART_HEIGHT, 2, "=l0"}, {PART_DIAMETER, 3, "diamet"}, {PART_DIAMETER, 3, "durchmesser"},
    {PART_DIAMETER, 3, "=d0"}, {PART_RADIUS, 3, "radius"}, {PART_RADIUS, 3, "=rayon"},
    {PART_RADIUS, 3, "=raggio"}, {PART_RADIUS, 3, "=radio"}, {PART_RADIUS, 3, "=raio"},
    {PART_AREA, 3, "=area"}, {PART_AREA, 3, "flache"}, {PART_AREA, 3, "querschnitt"},
    {PART_AREA, 3, "=section"}, {PART_AREA, 3, "=aire"}, {PART_AREA, 3, "=seccion"},
    {PART_AREA, 3, "sezione"}, {PART_AREA, 2, "=a0"}, {PART_AREA, 2, "=s0"},
    {PART_SPRING, 3, "springconstant"}, {PART_SPRING, 3, "spring constant"},
    {PART_SPRING, 3, "spring_constant"}, {PART_SPRING, 3, "federkonstante"},
    {PART_SENSITIVITY, 3, "=sensitivity"}, {PART_SENSITIVITY, 3, "invols"},
    {PART_RATE, 3, "sampling rate"}, {PART_RATE, 3, "sample rate"}, {PART_RATE, 3, "data rate"},
    {PART_RATE, 3, "acquisition rate"}, {PART_RATE, 3, "sampling frequency"},
    {PART_RATE, 3, "sample frequency"}, {PART_RATE, 3, "abtastrate"}, {PART_RATE, 3, "abtastfrequenz"},
    {PART_RATE, 3, "messrate"}, {PART_RATE, 3, "frequence d'echantillonnage"},
    {PART_RATE, 3, "frequenza di campionamento"}, {PART_RATE, 3, "frecuencia de muestreo"},
    {PART_RATE, 3, "frequencia de amostragem"}, {PART_RATE, 2, "samplerate"},
    {PART_RATE, 2, "sample_rate"}, {PART_RATE, 2, "sampling_rate"},
    {PART_INTERVAL, 3, "sampling interval"}, {PART_INTERVAL, 3, "sample interval"},
    {PART_INTERVAL, 3, "sampling time"}, {PART_INTERVAL, 3, "delta_x"},
    {PART_INTERVAL, 3, "abtastintervall"}, {PART_INTERVAL, 2, "=dt"}, {PART_TIP_RADIUS, 3, "tip radius"},
    {PART_TIP_RADIUS, 3, "tip_radius"}, {PART_TIP_RADIUS, 3, "indenter radius"},
    {PART_TIP_RADIUS, 3, "probe radius"}, {PART_TIP_RADIUS, 3, "punch radius"},
    {PART_TIP_RADIUS, 3, "kugelradius"}, {PART_TIP_DIAMETER, 3, "tip diameter"},
    {PART_TIP_DIAMETER, 3, "indenter diameter"}, {PART_TIP_DIAMETER, 3, "probe diameter"},
    {PART_TIP_DIAMETER, 3, "punch diameter"}, {PART_TIP_DIAMETER, 3, "kugeldurchmesser"},
    {PART_TIP_DIAMETER, 3, "stempeldurchmesser"}, {PART_HEIGHT, 4, "高度"}, {PART_HEIGHT, 4, "高さ"},
    {PART_HEIGHT, 2, "厚度"}, {PART_HEIGHT, 2, "厚さ"}, {PART_DIAMETER, 3, "直径"},
    {PART_DIAMETER, 3, "直徑"},
    {PART_RADIUS, 3, "半径"}, {PART_RADIUS, 3, "半徑"}, {PART_AREA, 3, "面积"},
    {PART_AREA, 3, "面積"}};
/* clang-format on */

/* A length of these is none of the specimen, nor a spring constant. */
static const char *const elsewhere[] = {
    "probe diam", "indent",  "punch",  "=tip",     "tip_",   "plate",      "platte",     "stempel",
    "anvil",      "limit",   "offset", "=max",     "=min",   "final",      "wave",       "scan",
    "path",       "loading", "field",  "cable",    "step",   "multiplier", "cantilever", "buffer",
    "k-length",   "file",    "=data",  "at break", "record", "sensor",     "setpoint",   "sample rate",
    "=rate",      "after",   "=end",   "trigger"};

int import_part_rank(const char *name, int part) {
    char plain[IMPORT_WORD];
    int rank = 0;
    import_plain(name, true, plain, sizeof plain);
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if (parts[i].role == part && parts[i].rank > rank && has_word(plain, parts[i].text))
            rank = parts[i].rank;
    return part < PART_RATE && has_any(plain, sizeof elsewhere / sizeof *elsewhere, elsewhere) ? 0 : rank;
}
