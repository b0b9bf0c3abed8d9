/* test_firmware.c: palpate firmware against a peer: what it prints, and its exit codes. */
/* link: -pthread */
#define _POSIX_C_SOURCE 200809L
#include "shared/cli.h"
#include "shared/commands.h"
#include "device_peer.h"

#include <jansson.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

static char out[8192], err[1024];

static int begin_capture(int fd, FILE *to) {
    int kept = dup(fd);
    assert_non_null(to);
    dup2(fileno(to), fd);
    return kept;
}

static void end_capture(int fd, int kept, FILE *from, char *text, size_t size) {
    dup2(kept, fd);
    close(kept);
    rewind(from);
    text[fread(text, 1, size - 1, from)] = '\0';
    fclose(from);
}

/* palpate firmware ACTION --port (the peer) [option]; what it writes goes to out and err. */
static int run(const peer_settings *settings, char *action, char *option) {
    char name[] = "firmware", port[] = "--port", where[20];
    char *argv[] = {name, action, port, where, option, NULL};
    int end[2];
    peer p;
    FILE *to_out = tmpfile(), *to_err = tmpfile();
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM, 0, end), 0);
    snprintf(where, sizeof where, "fd:%d", end[0]);
    peer_start(&p, end[1], settings);
    fflush(stdout);
    int kept_out = begin_capture(STDOUT_FILENO, to_out), kept_err = begin_capture(STDERR_FILENO, to_err);
    int code = cmd_firmware(option ? 5 : 4, argv);
    fflush(stdout);
    end_capture(STDOUT_FILENO, kept_out, to_out, out, sizeof out);
    end_capture(STDERR_FILENO, kept_err, to_err, err, sizeof err);
    peer_stop(&p);
    if (p.fd >= 0)
        close(p.fd);
    return code;
}

static char info[] = "info", status[] = "status", gains[] = "gains", home[] = "home", tare[] = "tare",
            clear[] = "clear-fault", json[] = "--json";

static void says(const char *text, const char *part) {
    if (!strstr(text, part))
        fail_msg("\"%s\" does not say \"%s\"", text, part);
}

static double number(json_t *object, const char *key) {
    json_t *value = json_object_get(object, key);
    if (!json_is_number(value))
        fail_msg("no number %s in %s", key, out);
    return json_number_value(value);
}

static json_t *printed(void) {
    json_t *it = json_loads(out, 0, NULL);
    if (!it)
        fail_msg("no JSON: %s", out);
    return it;
}

static void test_info(void **state) {
    const peer_settings its = {0};
    (void)state;
    assert_int_equal(run(&its, info, NULL), CLI_OK);
    says(out, "board              peer\n");
    says(out, "serial             4711\n");
    assert_int_equal(run(&its, info, json), CLI_OK);
    json_t *it = printed();
    assert_true(number(it, "serial") == 4711 && number(it, "count_um") == 1 &&
                number(it, "protocol") == PALP_WIRE_VERSION);
    json_decref(it);
}

static void test_status(void **state) {
    peer_settings its = {.status = {.state = PALP_WIRE_STATE_FAULT,
                                    .fault = PALP_WIRE_FAULT_OVER_FORCE,
                                    .position = -5000,
                                    .contact = 12000,
                                    .case_cC = 2350,
                                    .derating_permille = 500}};
    (void)state;
    assert_int_equal(run(&its, status, NULL), CLI_OK);
    says(out, "state              fault\nfault              over_force\n");
    says(out, "position_mm        -5\ncontact_mm         unknown\n");
    its.status.contact_known = 1;
    assert_int_equal(run(&its, status, json), CLI_OK);
    json_t *it = printed();
    assert_true(number(it, "contact_mm") == 12 && number(it, "case_C") == 23.5 &&
                number(it, "derating") == 0.5);
    json_decref(it);
}

static void test_gains(void **state) {
    const peer_settings its = {.classes = 6};
    (void)state;
    assert_int_equal(run(&its, gains, json), CLI_OK);
    json_t *it = printed();
    assert_int_equal(json_array_size(it), 6);
    assert_true(number(json_array_get(it, 5), "kp_N_m") == 500);
    json_decref(it);
    assert_int_equal(run(&its, gains, NULL), CLI_OK);
    says(out, "  softness_class       up_to_N_m          kp_N_m");
}

static void test_home(void **state) {
    peer_settings its = {.status = {.state = PALP_WIRE_STATE_READY, .homed = 1}};
    (void)state;
    assert_int_equal(run(&its, home, NULL), CLI_OK);
    says(out, "homed              yes\n");
    its.status = (palp_wire_status){.state = PALP_WIRE_STATE_IDLE};
    assert_int_equal(run(&its, home, NULL), CLI_FAILURE);
    says(err, "palpate firmware: the home position was not found (state idle)\n");
    its.status = (palp_wire_status){.state = PALP_WIRE_STATE_FAULT, .fault = PALP_WIRE_FAULT_SENSOR_SILENT};
    assert_int_equal(run(&its, home, NULL), CLI_DEVICE_FAULT);
    says(err,
         "the device stopped: sensor_silent (the force sensor does not answer); see to it, then palpate");
    its.refuse = PALP_WIRE_TYPE_HOME;
    its.result = PALP_WIRE_RESULT_FAULTED;
    assert_int_equal(run(&its, home, NULL), CLI_DEVICE_FAULT);
    says(err, "the device refused HOME: a fault is latched; clear it first\n");
}

static void test_tare(void **state) {
    const peer_settings its = {.status_ticks = 400};
    (void)state;
    assert_int_equal(run(&its, tare, NULL), CLI_OK);
    says(out, "tare_counts        -1.5 0.5 0 0 0 0\n");
}

static void test_clear(void **state) {
    peer_settings its = {.status = {.state = PALP_WIRE_STATE_IDLE}};
    (void)state;
    assert_int_equal(run(&its, clear, NULL), CLI_OK);
    says(out, "state              idle\n");
    its.refuse = PALP_WIRE_TYPE_CLEAR_FAULT; /* nothing to clear is no failure */
    its.result = PALP_WIRE_RESULT_STATE;
    assert_int_equal(run(&its, clear, NULL), CLI_OK);
    its = (peer_settings){.status = {.state = PALP_WIRE_STATE_FAULT, .fault = PALP_WIRE_FAULT_EMERGENCY_STOP},
                          .refuse = PALP_WIRE_TYPE_CLEAR_FAULT,
                          .result = PALP_WIRE_RESULT_PERSISTS};
    assert_int_equal(run(&its, clear, NULL), CLI_DEVICE_FAULT);
    says(err,
         "palpate firmware: the cause of emergency_stop is still there: the emergency stop was pressed\n");
}

static void test_failures(void **state) {
    char wrong[] = "dance";
    (void)state;
    assert_int_equal(run(&(peer_settings){.protocol = 9}, info, NULL), CLI_FAILURE);
    says(err, "palpate firmware: fd:");
    says(err, "the device speaks protocol 9, this palpate 3");
    assert_int_equal(run(&(peer_settings){.closes = true}, info, NULL), CLI_FAILURE);
    says(err, "the other end has closed");
    assert_int_equal(run(&(peer_settings){0}, wrong, NULL), CLI_USAGE);
    says(err, "no such action: dance");
}

const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_info),     cmocka_unit_test(test_status),
    cmocka_unit_test(test_gains),    cmocka_unit_test(test_home),
    cmocka_unit_test(test_tare),     cmocka_unit_test(test_clear),
    cmocka_unit_test(test_failures), {0},
};
