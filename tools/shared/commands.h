/* commands.h: the subcommands, each run with argv[0] its own name; they return the exit code. */
#ifndef PALPATE_COMMANDS_H
#define PALPATE_COMMANDS_H

int cmd_acquire(int argc, char **argv);
int cmd_panel(int argc, char **argv);
int cmd_calibrate_device(int argc, char **argv);
int cmd_firmware(int argc, char **argv);
int cmd_rig(int argc, char **argv);
int cmd_import(int argc, char **argv);
int cmd_characterize(int argc, char **argv);
int cmd_report(int argc, char **argv);
int cmd_simulate(int argc, char **argv);
int cmd_calibrate(int argc, char **argv);
int cmd_inclusion(int argc, char **argv);
int cmd_reduce(int argc, char **argv);
int cmd_explain(int argc, char **argv);
int cmd_export(int argc, char **argv);
int cmd_batch(int argc, char **argv);
int cmd_benchmark(int argc, char **argv);

#endif
