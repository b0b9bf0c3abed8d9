/* acquire_setup.c: the options for device, specimen and output folder that commands share. */
#include "acquire_setup.h"

#include <math.h>
#include <palpate/model.h>
#include <string.h>

acquire_setup acquire_setup_default(void) {
    acquire_setup u = {.baud = LINK_BAUD};
    u.rig = rig_options_default();
    u.session.contact_N = 0.01;
    u.session.command = "acquire";
    return u;
}

size_t acquire_setup_device(acquire_setup *u, cli_option *list) {
    acquire_options *o = &u->session;
    const cli_option all[] = {
        cli_heading("Device"),
        cli_text("port", "PORT", &o->port,
                 "/dev/ttyACM0, pty:PATH, tcp:HOST:PORT, or rig[:MODEL.json]: the\n"
                 "virtual indenter, on a model or the thesis' phantom"),
        cli_count("baud", "N", 1200, 4e6, &u->baud, "baud rate of a serial port (default 921600)"),
        cli_choice("gains", "auto|0|1|2|3|4|5", &u->gains,
                   "control gains by class of stiffness, 0 the softest (default auto: by\n"
                   "the stiffness measured while contact is found)"),
        cli_positive("contact-N", "F", 10, &o->contact_N,
                     "contact is where the force exceeds that in air by F newtons\n(default 0.01)"),
        cli_flag("keep-contact", &o->keep_contact,
                 "do not home and find contact again: use the device's values"),
        cli_positive("limit-force-N", "F", 1000, &o->limit_N,
                     "stop at this force, N (default: the device's limit)"),
        cli_positive("limit-travel-mm", "MM", 1000, &o->limit_mm,
                     "lowest place of the plate, mm below home (default: the device's travel)"),
        cli_positive("limit-winding-C", "T", 300, &o->limit_C,
                     "stop at this motor temperature (default: the device's limit)"),
        cli_number("host-timeout-s", "S", 0.1, 60, &o->host_timeout_s,
                   "the device stops if this program is silent for S seconds (default 5;\n"
                   "virtual indenter, whose clock may be faster: 60)"),
        cli_in("calibration", "FILE", &u->calibration, "calibration matrix of the force sensor, JSON"),
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

size_t acquire_setup_specimen(acquire_setup *u, cli_option *list) {
    acquire_options *o = &u->session;
    const cli_option all[] = {
        cli_heading("Specimen"),
        cli_positive("specimen-height-mm", "MM", 1e4, &o->height_mm,
                     "height, mm (default: from the virtual indenter's model)"),
        cli_positive("specimen-radius-mm", "MM", 1e4, &o->radius_mm, "radius, mm"),
        cli_text("specimen-kind", "KIND", &o->specimen_kind, "cylinder, rigid or another word"),
        cli_text("specimen-name", "NAME", &o->specimen, "name of the specimen"),
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

size_t acquire_setup_columns(acquire_setup *u, cli_option *list) {
    const cli_option all[] = {
        cli_flag("raw", &u->raw, "more columns: error, position and ADC counts, duty, flags"),
        cli_text("channels", "NAMES", &u->channels,
                 "more columns: forces (Fx, Fy, Fz, Tx, Ty, Tz by the full matrix),\n"
                 "temperature (of the motor's case), or both: forces,temperature"),
    };
    memcpy(list, all, sizeof all);
    return sizeof all / sizeof all[0];
}

static bool is_rig(const acquire_setup *u) {
    return strcmp(u->session.port, "rig") == 0 || strncmp(u->session.port, "rig:", 4) == 0;
}

static const char *model_of(const acquire_setup *u) {
    return u->session.port[3] ? u->session.port + 4 : NULL;
}

static int set_columns(const char *name, acquire_setup *u) {
    const unsigned named = u->channels ? acquire_columns(u->channels) : 0;
    u->session.columns |= named | (u->raw ? ACQUIRE_RAW : 0);
    return !u->channels || named
               ? CLI_OK
               : cli_usage_error(name,
                                 "--channels must be forces, temperature or both with a comma, not \"%s\"",
                                 u->channels);
}

int acquire_setup_check(const char *name, acquire_setup *u) {
    u->session.baud = (int)u->baud;
    u->session.gains = u->gains == 0 ? PALP_WIRE_GAINS_AUTO : u->gains - 1;
    if (!u->session.port)
        return cli_usage_error(name,
                               "name the device with --port; palpate acquire --list shows the serial ports");
    if (!u->session.out)
        return cli_usage_error(name, "name the folder of the recordings by --out DIR");
    if (!is_rig(u) && rig_options_given(&u->rig))
        return cli_usage_error(name, "--%s needs --port rig", rig_options_given(&u->rig));
    const int code = set_columns(name, u);
    return code || !u->calibration
               ? code
               : acquire_calibration_read(u->calibration, u->session.row, u->session.calibration);
}

/* path NULL: the phantom of the thesis. */
static int specimen_of_model(const char *name, const char *path, acquire_setup *u) {
    acquire_options *o = &u->session;
    palp_error error = {PALP_OK, ""};
    palp_model model = {.height_m = 24e-3, .radius_m = 12e-3, .specimen_kind = "cylinder"};
    palp_status status = path ? palp_model_read(path, &model, NULL, &error) : PALP_OK;
    if (status == PALP_OK) {
        o->height_mm = o->height_mm > 0 ? o->height_mm : 1e3 * model.height_m;
        o->radius_mm = o->radius_mm > 0 ? o->radius_mm : 1e3 * model.radius_m;
        memcpy(u->kind, model.specimen_kind, sizeof u->kind);
        o->specimen_kind = o->specimen_kind || !*u->kind ? o->specimen_kind : u->kind;
    }
    return status ? cli_status(name, status, &error) : CLI_OK;
}

int acquire_setup_prepare(const char *name, acquire_setup *u) {
    rig_settings *settings = &u->settings;
    if (!is_rig(u))
        return CLI_OK;
    int code = rig_options_settings(name, &u->rig, model_of(u), settings);
    if (code == CLI_OK && settings->plant.specimen == PLANT_MODEL)
        code = specimen_of_model(name, settings->plant.model, u);
    else if (code == CLI_OK && !u->session.specimen_kind)
        u->session.specimen_kind = settings->plant.specimen == PLANT_RIGID ? "rigid" : "none";
    return code;
}

int acquire_setup_open(const char *name, acquire_setup *u) {
    u->session.where = u->session.port;
    if (!is_rig(u))
        return CLI_OK;
    const char *model = model_of(u);
    int code = model && u->rig.log ? cli_output_check(name, u->rig.log, u->session.force, 1, &model) : CLI_OK;
    code = code ? code : rig_open(name, &u->settings, &u->virtual_one);
    u->session.where = u->virtual_one.port;
    return code;
}

int acquire_setup_close(acquire_setup *u) {
    return is_rig(u) ? rig_close(&u->virtual_one) : CLI_OK;
}
