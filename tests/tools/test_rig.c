/* test_rig.c: the virtual indenter's loop, feed and process, with this program as the firmware. */
#define _GNU_SOURCE
#include "shared/cli.h"
#include "app.h"
#include "rig/rig_internal.h"
#include "rig/rig_options.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>
#include <palpate/wire.h>

enum { RECORDS = 400, DUTY = 3000 };
static const char NAME[] = "test";
static char folder[PATH_MAX]; /* of this run of the tests */

static const char *in_folder(const char *file) {
    static char path[2 * PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, file);
    return path;
}

/* ---- the firmware: keeps what it is fed in a file, and does what FAKE says ---- */

static bool is(const char *what) {
    return strcmp(getenv("FAKE"), what) == 0;
}

static int fake(char **argv) {
    int in = open(argv[1], O_RDONLY), out = open(argv[2], O_WRONLY);
    int kept = open(getenv("FAKE_RECORDS"), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    plant_out next = {.boot = 1, .version = (uint16_t)(is("version") ? 9 : PLANT_LINK_VERSION)};
    FILE *own = fopen(getenv("FAKE_PID"), "w");
    fprintf(own, "%d\n", (int)getpid());
    fclose(own);
    next.tx_count = 1; /* the first byte of all, as of a firmware that has started */
    for (uint32_t n = 0; !is("mute"); n++) {
        uint8_t record[PLANT_LINK_IN], answer[PLANT_LINK_OUT];
        plant_in now;
        if (is("dies") && n == 5) {
            dprintf(2, "on fire\nit is broken\n");
            return 3;
        }
        plant_link_put_out(&next, answer);
        if (write(out, answer, sizeof answer) < 0 ||
            read(in, record, sizeof record) != (ssize_t)sizeof record ||
            write(kept, record, sizeof record) < 0) {
            return 1;
        }
        plant_link_get_in(record, &now);
        next.boot = (now.events & PLANT_EVENT_HANG) != 0;
        next.duty = DUTY;
        next.motor = !next.boot;
        next.cost = n;
        next.tx_count = now.rx_count; /* sends back what comes, changed, so that the test sees it was here */
        for (int i = 0; i < PLANT_LINK_RX; i++) {
            next.tx[i] = (uint8_t)(now.rx[i] + 1);
        }
        if (now.events & PLANT_EVENT_QUIT) {
            next.tx_count = 0;
            plant_link_put_out(&next, answer);
            return write(out, answer, sizeof answer) < 0;
        }
    }
    pause();
    return 0;
}

/* ---- around a run ---- */

static int only_name(const struct dirent *entry) {
    return strncmp(entry->d_name, "palpate.", 8) == 0;
}

static void no_folder_is_left(void) {
    struct dirent **list;
    assert_int_equal(scandir(folder, &list, only_name, NULL), 0);
    free(list);
}

static void remove_folders(void) {
    struct dirent **list;
    int n = scandir(folder, &list, only_name, NULL);
    for (int i = 0; i < n; i++) {
        static const char *const files[] = {"/in", "/out", ""};
        for (size_t k = 0; k < 3; k++) {
            char path[2 * PATH_MAX + 8];
            snprintf(path, sizeof path, "%s%s", in_folder(list[i]->d_name), files[k]);
            remove(path);
        }
        free(list[i]);
    }
    free(list);
}

static rig_settings start_with(const char *what) {
    rig_settings s = rig_settings_default();
    setenv("FAKE", what, 1);
    s.firmware = RIG_HOST;
    s.until_s = 0.05;
    s.plant.actuator.start_m = 0.0115;
    return s;
}

static size_t read_records(plant_in *in) {
    uint8_t record[PLANT_LINK_IN];
    FILE *file = fopen(getenv("FAKE_RECORDS"), "r");
    size_t n = 0;
    while (file && n < RECORDS && fread(record, sizeof record, 1, file) == 1) {
        plant_link_get_in(record, &in[n++]);
    }
    if (file) {
        fclose(file);
    }
    return n;
}

static const volatile int go;

/* Runs it, stderr going to a file; that must have text in it if text is not NULL. */
static int run(const rig_settings *s, rig_figures *figures, const char *text) {
    char said[1024] = "";
    int kept = dup(2), to = open(in_folder("err"), O_RDWR | O_CREAT | O_TRUNC, 0600);
    dup2(to, 2);
    int code = rig_run(NAME, s, &go, NULL, NULL, figures);
    dup2(kept, 2);
    assert_true(pread(to, said, sizeof said - 1, 0) >= 0);
    close(kept);
    close(to);
    if (text && (!strstr(said, text) || strchr(said, '\n') != said + strlen(said) - 1)) {
        fail_msg("\"%s\" is not one line with \"%s\"", said, text);
    }
    no_folder_is_left();
    return code;
}

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

/* ---- script ---- */

static const char *script(const char *text) {
    FILE *file = fopen(in_folder("script"), "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    return in_folder("script");
}

static void test_script(void **state) {
    static plant_in fed[RECORDS];
    char text[512] = "0 00ff\n7 01\n7 0203\n9 ", path[PATH_MAX];
    rig_settings s = start_with("runs");
    (void)state;
    for (int i = 0; i < 50; i++) {
        strcat(text, "aB");
    }
    strcpy(path, script(strcat(text, "\n")));
    s.script = path;
    assert_int_equal(run(&s, NULL, NULL), CLI_OK);
    size_t n = read_records(fed);
    assert_int_equal(n, 51);
    for (size_t i = 0; i < n; i++) {
        assert_int_equal(fed[i].rx_count, i == 0    ? 2
                                          : i == 7  ? 3
                                          : i == 9  ? PLANT_LINK_RX
                                          : i == 10 ? 50 - PLANT_LINK_RX
                                                    : 0);
    }
    assert_int_equal(fed[0].rx[1], 0xff);
    assert_memory_equal(fed[7].rx, "\1\2\3", 3);
    assert_int_equal(fed[10].rx[13], 0xab);
}

static void test_bad_scripts(void **state) {
    static const char *const bad[][2] = {{"5 00\n4 00\n", ":2: its tick is before"},
                                         {"5 0\n", ":1: wants pairs"},
                                         {"5 00 gg\n", ":1: wants pairs"},
                                         {"5 \n", ":1: wants pairs"},
                                         {"5\n", ":1: wants TICK"},
                                         {"\n", ":1: wants TICK"},
                                         {"-1 00\n", ":1: wants TICK"},
                                         {"1 00\n99999999999 00\n", ":2: wants TICK"}};
    rig_settings s = start_with("runs");
    char path[PATH_MAX];
    (void)state;
    s.script = path;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        strcpy(path, script(bad[i][0]));
        assert_int_equal(run(&s, NULL, bad[i][1]), CLI_FAILURE);
    }
    remove(path);
    assert_int_equal(run(&s, NULL, "script: "), CLI_FAILURE);
}

/* ---- what goes wrong ---- */

static void test_firmware_that_fails(void **state) {
    rig_settings s = start_with("dies");
    (void)state;
    assert_int_equal(run(&s, NULL, "the firmware has ended: it is broken"), CLI_FAILURE);
    s = start_with("version");
    assert_int_equal(run(&s, NULL, "has version 9, not 3"), CLI_FAILURE);
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

/* It tells the port, once, and ends when asked to. */
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

/* Whether a process ends within some seconds. */
static bool goes_away(pid_t process) {
    for (int i = 0; i < 1000; i++) {
        if (kill(process, 0) != 0 && errno == ESRCH) {
            return true;
        }
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    return false;
}

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

/* The firmware ends with its parent, however that ends. */
static void test_killed(void **state) {
    int line[2], number;
    rig_settings s = start_with("runs");
    (void)state;
    s.until_s = 0;
    assert_int_equal(pipe(line), 0);
    pid_t parent = fork();
    if (parent == 0) {
        _exit(rig_run(NAME, &s, &go, say_pid, &line[1], NULL));
    }
    assert_int_equal(read(line[0], &number, sizeof number), sizeof number);
    assert_int_equal(kill(number, 0), 0);
    kill(parent, SIGKILL);
    assert_int_equal(waitpid(parent, NULL, 0), parent);
    assert_true(goes_away(number));
    remove_folders(); /* nobody else is left to do it */
    close(line[0]);
    close(line[1]);
}

/* ---- options ---- */

static int parse(const char *line, rig_options *o) {
    char text[512], *argv[32] = {NULL};
    int argc = 0;
    cli_option list[RIG_OPTIONS];
    size_t n;
    strcpy(text, line);
    for (char *word = strtok(text, " "); word; word = strtok(NULL, " ")) {
        argv[argc++] = word;
    }
    *o = rig_options_default();
    rig_options_list(o, list);
    const cli_command command = {NAME, "", "", "", list, RIG_OPTIONS};
    int code = cli_parse(&command, argc, argv, NULL, 0, &n);
    static char kept[512]; /* of the texts, which point into this function's */
    if (o->inject) {
        o->inject = strcpy(kept, o->inject);
    }
    return code;
}

static void test_options(void **state) {
    rig_options o;
    rig_settings s, plain = rig_settings_default();
    (void)state;
    assert_int_equal(parse("test", &o), CLI_OK);
    assert_null(rig_options_given(&o));
    assert_int_equal(rig_options_settings(NAME, &o, NULL, &s), CLI_OK);
    assert_memory_equal(&s.plant, &plain.plant, sizeof s.plant);
    assert_int_equal(
        parse("test --scale 2 --contact-mm 20 --noise-N 0 --bias-N -0.5 --seed 7 --firmware host --paced "
              "--inject over_force@3.5,sensor_silent@7-8.25",
              &o),
        CLI_OK);
    assert_string_equal(rig_options_given(&o), "firmware");
    assert_int_equal(rig_options_settings(NAME, &o, "m.json", &s), CLI_OK);
    assert_string_equal(s.plant.model, "m.json");
    assert_true(s.plant.scale == 2 && fabs(s.plant.contact_m - 0.02) < 1e-15 && s.plant.sensor.noise_N == 0);
    assert_true(s.plant.sensor.bias_N == -0.5 && s.plant.sensor.seed == 7 && s.paced &&
                s.firmware == RIG_HOST);
    assert_int_equal(s.n_injections, 2);
    assert_int_equal(s.injection[0].fault, PALP_WIRE_FAULT_OVER_FORCE);
    assert_true(s.injection[0].time_s == 3.5 && s.injection[0].until_s == 0);
    assert_int_equal(s.injection[1].fault, PALP_WIRE_FAULT_SENSOR_SILENT);
    assert_true(s.injection[1].time_s == 7 && s.injection[1].until_s == 8.25);
}

static void test_bad_options(void **state) {
    static const char *const bad[] = {"over_force",
                                      "over_force@",
                                      "over_force@x",
                                      "over_force@3-2",
                                      "over_force@3-",
                                      "over_force@-1",
                                      "over_force@3s",
                                      "no_fault@1",
                                      "none@1",
                                      "over_force@1,,",
                                      "@1",
                                      "over_force@1;hot@2",
                                      "over_force@1-2-3",
                                      "over_force@1e99",
                                      "over_force@1,hot@2"};
    rig_options o;
    rig_settings s;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        o = rig_options_default();
        o.inject = bad[i];
        assert_int_equal(rig_options_settings(NAME, &o, NULL, &s), CLI_USAGE);
    }
    assert_int_equal(parse("test --specimen none", &o), CLI_OK);
    assert_int_equal(rig_options_settings(NAME, &o, NULL, &s), CLI_OK);
    assert_int_equal(rig_options_settings(NAME, &o, "m.json", &s), CLI_USAGE);
    o = rig_options_default();
    o.actuator = "no/such/actuator.json";
    assert_int_equal(rig_options_settings(NAME, &o, NULL, &s), CLI_FAILURE);
}

/* The firmware that rig_find finds is this program, by a link to it. */
static void set_up(void) {
    const char *scratch = getenv("SCRATCH");
    char own[PATH_MAX] = "", base[PATH_MAX];
    snprintf(base, sizeof base, "%s/palpate-test.XXXXXX", scratch && strlen(scratch) < 50 ? scratch : "/tmp");
    if (!mkdtemp(base) || readlink("/proc/self/exe", own, sizeof own - 1) <= 0) {
        exit(1);
    }
    strcpy(folder, base);
    if (symlink(own, in_folder("indenter_host")) != 0) {
        exit(1);
    }
    setenv("TMPDIR", folder, 1);
    setenv("PALPATE_FIRMWARE", folder, 1);
    setenv("FAKE_RECORDS", in_folder("records"), 1);
    setenv("FAKE_PID", in_folder("pid"), 1);
}

static void clean_up(void) {
    static const char *const files[] = {"indenter_host", "records", "pid", "err", "log.csv", "script"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        remove(in_folder(files[i]));
    }
    rmdir(folder);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lockstep),
        cmocka_unit_test(test_log),
        cmocka_unit_test(test_paced),
        cmocka_unit_test(test_injections),
        cmocka_unit_test(test_commands_and_restarts),
        cmocka_unit_test(test_script),
        cmocka_unit_test(test_bad_scripts),
        cmocka_unit_test(test_firmware_that_fails),
        cmocka_unit_test(test_no_firmware),
        cmocka_unit_test(test_port_and_stop),
        cmocka_unit_test(test_child),
        cmocka_unit_test(test_child_that_fails),
        cmocka_unit_test(test_killed),
        cmocka_unit_test(test_options),
        cmocka_unit_test(test_bad_options),
    };
    if (argc == 3 && strcmp(argv[1], "in") == 0) {
        return fake(argv);
    }
    set_up();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    clean_up();
    return failed;
}
