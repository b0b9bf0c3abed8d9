/* beside.h: files that come with the command. */
#ifndef PALPATE_BESIDE_H
#define PALPATE_BESIDE_H

#include "cli.h"

/* Where such a file is: beside the command, as it is built, or in ../lib/palpate/, as it is installed. */
bool beside_command(const char *file, char path[CLI_PATH_MAX]);

#endif
