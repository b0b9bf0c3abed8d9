/* test_rig.c: the virtual indenter's loop, feed and process, with this program as the firmware. */
#define _GNU_SOURCE
#include "rig_make.h"

#include <sys/prctl.h>

/* ---- lockstep ---- */

/* The records are those of the plant alone under the same outputs, to the bit. */
static void test_lockstep(void **state) {
    rig_settings s = start_with("runs");
    static plant_in fed[RECORDS];
    plant_in wanted;
    plant *p;
    rig_figures f;
    (void)state;
    assert_int_equal(run(&s, &f, NULL), CLI_OK);
    size_t n = read_records(fed);
    assert_int_equal(n, 51);
    assert_int_equal(plant_create(&s.plant, &p, NULL), PALP_OK);
    plant_first(p, &wanted);
    for (uint32_t i = 0; i < n; i++) {
        plant_out out = {.duty = DUTY, .motor = PLANT_MOTOR_ON};
        if (i > 0) {
            assert_int_equal(plant_step(p, &out, &wanted, NULL), PALP_OK);
        }
        wanted.events = i == 50 ? PLANT_EVENT_QUIT : 0;
        assert_int_equal(wanted.tick, i);
        assert_memory_equal(&fed[i], &wanted, sizeof wanted);
    }
    assert_true(plant_look(p).force_N > 0);
    assert_int_equal(f.ticks, 50);
    assert_int_equal(f.cost, 49);
    assert_int_equal(f.restarts, 0);
    plant_free(p);
}

static void test_log(void **state) {
    rig_settings s = start_with("runs");
    char line[512];
    double time = 0, last[4] = {0};
    int lines = 0;
    (void)state;
    s.log = strdup(in_folder("log.csv"));
    assert_int_equal(run(&s, NULL, NULL), CLI_OK);
    FILE *file = fopen(s.log, "r");
    assert_non_null(file);
    assert_non_null(fgets(line, sizeof line, file));
    assert_int_equal(strncmp(line, "time_s,carriage_mm,", 19), 0);
    while (fgets(line, sizeof line, file)) {
        assert_int_equal(sscanf(line, "%lf,%lf,%lf,%lf", &time, &last[0], &last[1], &last[2]), 4);
        assert_true(fabs(time - 1e-3 * lines++) < 1e-9);
    }
    fclose(file);
    assert_int_equal(lines, 51);
    assert_true(last[0] > 11.5 && fabs(last[0] - 12 - last[2]) < 1e-5);
    free((char *)(uintptr_t)s.log);
    s.log = "/no/such/folder/log.csv";
    assert_int_equal(run(&s, NULL, "/no/such/folder/log.csv: "), CLI_FAILURE);
}

/* Every tick at its time or after it. */
static void test_paced(void **state) {
    rig_settings s = start_with("runs");
    rig_figures f;
    (void)state;
    s.paced = true;
    assert_int_equal(run(&s, &f, NULL), CLI_OK);
    assert_true(f.elapsed_s >= 0.05);
    assert_true(f.late <= 51 && f.worst_s < f.elapsed_s);
}

/* ---- faults ---- */

static void has_limits(const plant_in *in, double carriage_m) {
    palp_wire_decoder decoder = {0};
    palp_wire_message message;
    int frames = 0;
    for (int i = 0; i < in->rx_count; i++) {
        frames += palp_wire_decode(&decoder, in->rx[i], &message);
    }
    assert_int_equal(frames, 1);
    assert_int_equal(decoder.bad, 0);
    assert_int_equal(message.type, PALP_WIRE_TYPE_LIMITS);
    assert_int_equal(message.as.limits.force_uN, 0);
    assert_true(fabs(message.as.limits.travel_nm - 1e9 * (carriage_m - 1e-4)) < 2000);
}

/* Each shows in the record of its tick, not in the one before, and is gone when it is lifted. */
static void test_injections(void **state) {
    static const struct {
        int fault;
        uint8_t events, switches;
    } seen[] = {{PALP_WIRE_FAULT_OVER_FORCE, 0, 0},
                {PALP_WIRE_FAULT_OVER_TRAVEL, 0, 0},
                {PALP_WIRE_FAULT_OVER_TEMPERATURE, 0, 0},
                {PALP_WIRE_FAULT_FOLLOWING_ERROR, 0, 0},
                {PALP_WIRE_FAULT_SENSOR_SILENT, 0, PLANT_SENSOR_SILENT},
                {PALP_WIRE_FAULT_SENSOR_SATURATED, 0, 0},
                {PALP_WIRE_FAULT_ENCODER_JUMP, 0, 0},
                {PALP_WIRE_FAULT_HOST_TIMEOUT, PLANT_EVENT_DEAF, 0},
                {PALP_WIRE_FAULT_STREAM_OVERFLOW, PLANT_EVENT_STALL_TX, 0},
                {PALP_WIRE_FAULT_EMERGENCY_STOP, 0, PLANT_SWITCH_EMERGENCY}};
    static plant_in plain[RECORDS], fed[RECORDS];
    rig_settings s = start_with("runs");
    (void)state;
    assert_int_equal(run(&s, NULL, NULL), CLI_OK);
    size_t n = read_records(plain);
    for (size_t i = 0; i < sizeof seen / sizeof seen[0]; i++) {
        s.n_injections = 1;
        s.injection[0] = (rig_injection){seen[i].fault, 0.01, 0.02};
        assert_int_equal(run(&s, NULL, NULL), CLI_OK);
        assert_int_equal(read_records(fed), n);
        assert_memory_equal(fed, plain, 10 * sizeof fed[0]);
        assert_memory_not_equal(&fed[10], &plain[10], sizeof fed[0]);
        for (size_t k = 10; k < n - 1; k++) {
            assert_int_equal(fed[k].events, k < 20 ? seen[i].events : 0);
            assert_int_equal(fed[k].switches, k < 20 ? seen[i].switches : 0);
        }
    }
}

static void test_commands_and_restarts(void **state) {
    static plant_in fed[RECORDS];
    rig_settings s = start_with("runs");
    rig_figures f;
    (void)state;
    s.n_injections = 3;
    s.injection[0] = (rig_injection){PALP_WIRE_FAULT_COMMAND_OUT_OF_RANGE, 0.01, 0};
    s.injection[1] = (rig_injection){PALP_WIRE_FAULT_STACK_GUARD, 0.02, 0};
    s.injection[2] = (rig_injection){PALP_WIRE_FAULT_WATCHDOG_RESET, 0.03, 0};
    assert_int_equal(run(&s, &f, NULL), CLI_OK);
    size_t n = read_records(fed);
    assert_int_equal(n, 52);
    for (size_t i = 0; i < n; i++) { /* the record of tick 30 comes again, as the first of a new start */
        assert_int_equal(fed[i].tick, i < 31 ? i : i - 1);
        assert_int_equal(fed[i].events, i == 20   ? PLANT_EVENT_SMASH
                                        : i == 30 ? PLANT_EVENT_HANG
                                        : i == 51 ? PLANT_EVENT_QUIT
                                                  : 0);
        assert_int_equal(fed[i].reset_cause, i == 31 ? APP_RESET_WATCHDOG : APP_RESET_POWER);
        assert_int_equal(fed[i].rx_count > 0, i == 10);
    }
    has_limits(&fed[10], s.plant.actuator.start_m + 1e-6 * fed[10].position);
    assert_true(fed[30].position > 100);
    assert_int_equal(fed[31].position, 0);
    assert_int_equal(f.restarts, 1);
}

/* ---- what goes wrong ---- */

static void test_firmware_that_fails(void **state) {
    rig_settings s = start_with("dies");
    (void)state;
    assert_int_equal(run(&s, NULL, "the firmware has ended: it is broken"), CLI_FAILURE);
    s = start_with("version");
    assert_int_equal(run(&s, NULL, "has version 9, not 4"), CLI_FAILURE);
    s = start_with("mute");
    s.patience_s = 0.2;
    assert_int_equal(run(&s, NULL, "does not answer"), CLI_FAILURE);
    s = start_with("runs");
    s.plant.model = "no/such/model.json";
    assert_int_equal(run(&s, NULL, "no/such/model.json"), CLI_FAILURE);
}

static void test_no_firmware(void **state) {
    rig_settings s = start_with("runs");
    char note[RIG_NOTE], kept[PATH_MAX];
    (void)state;
    strcpy(kept, getenv("PALPATE_FIRMWARE"));
    assert_true(rig_find(&s, note));
    assert_string_equal(note, "the host process");
    assert_string_equal(strrchr(s.image, '/') != NULL ? "full" : s.image, "full");
    setenv("PALPATE_FIRMWARE", "/no/such/folder", 1);
    s.image[0] = '\0';
    assert_false(rig_find(&s, note));
    assert_non_null(strstr(note, "indenter_host"));
    assert_int_equal(run(&s, NULL, "there is no indenter_host"), CLI_FAILURE);
    setenv("PALPATE_FIRMWARE", kept, 1);
}

static volatile int stop;
static char told[64];

static void stop_it(const char *port, void *context) {
    snprintf(told, sizeof told, "%s%s", port, (const char *)context);
    stop = 1;
}

/* It prints the port once, and ends when asked to. */
static void test_port_and_stop(void **state) {
    char mark[] = "!";
    rig_settings s = start_with("runs");
    (void)state;
    s.until_s = 0;
    stop = 0;
    assert_int_equal(rig_run(NAME, &s, &stop, stop_it, mark, NULL), CLI_OK);
    assert_int_equal(strncmp(told, "pty:/dev/pts/", 13), 0);
    assert_int_equal(told[strlen(told) - 1], '!');
    no_folder_is_left();
}

/* ---- in a child ---- */

static void test_child(void **state) {
    rig_settings s = start_with("runs");
    rig r;
    char byte = 'a';
    (void)state;
    s.until_s = 0;
    assert_int_equal(rig_open(NAME, &s, &r), CLI_OK);
    assert_int_equal(strncmp(r.port, "fd:", 3), 0);
    int fd = atoi(r.port + 3);
    assert_int_equal(read(fd, &byte, 1), 1);
    byte = 'a';
    assert_int_equal(write(fd, &byte, 1), 1);
    assert_int_equal(read(fd, &byte, 1), 1);
    assert_int_equal(byte, 'b');
    assert_int_equal(getpgid(r.child), r.child); /* Ctrl-C in the terminal does not reach it */
    assert_int_equal(rig_close(&r), CLI_OK);
    assert_int_equal(read(fd, &byte, 1), 0);
    close(fd);
    assert_int_equal(rig_close(&r), CLI_OK);
    no_folder_is_left();
}

static void test_child_that_fails(void **state) {
    rig_settings s = start_with("runs");
    rig r;
    (void)state;
    s.plant.model = "no/such/model.json";
    assert_int_equal(rig_open(NAME, &s, &r), CLI_FAILURE);
    assert_int_equal(r.child, 0);
    no_folder_is_left();
}

static void say_pid(const char *port, void *context) {
    FILE *own = fopen(getenv("FAKE_PID"), "r");
    int number = 0;
    (void)port;
    assert_non_null(own);
    assert_int_equal(fscanf(own, "%d", &number), 1);
    fclose(own);
    assert_int_equal(write(*(int *)context, &number, sizeof number), sizeof number);
}

/* The firmware ends with its parent, however that ends; it is then ours to wait for. */
static void test_killed(void **state) {
    int line[2], number;
    rig_settings s = start_with("runs");
    (void)state;
    s.until_s = 0;
    assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
    assert_int_equal(pipe(line), 0);
    pid_t parent = fork();
    if (parent == 0) {
        _exit(rig_run(NAME, &s, &go, say_pid, &line[1], NULL));
    }
    assert_int_equal(read(line[0], &number, sizeof number), sizeof number);
    assert_int_equal(kill(number, 0), 0);
    kill(parent, SIGKILL);
    assert_int_equal(waitpid(parent, NULL, 0), parent);
    assert_int_equal(waitpid(number, NULL, 0), number);
    remove_folders(); /* nobody else is left to do it */
    close(line[0]);
    close(line[1]);
}

static int tests(void) {
    const struct CMUnitTest all[] = {
        cmocka_unit_test(test_lockstep),
        cmocka_unit_test(test_log),
        cmocka_unit_test(test_paced),
        cmocka_unit_test(test_injections),
        cmocka_unit_test(test_commands_and_restarts),
        cmocka_unit_test(test_firmware_that_fails),
        cmocka_unit_test(test_no_firmware),
        cmocka_unit_test(test_port_and_stop),
        cmocka_unit_test(test_child),
        cmocka_unit_test(test_child_that_fails),
        cmocka_unit_test(test_killed),
    };
    return cmocka_run_group_tests(all, NULL, NULL);
}

int main(int argc, char **argv) {
    return rig_main(argc, argv, tests);
}
