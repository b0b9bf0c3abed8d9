/* firmware_test.h: the self-test of an indenter, on the bench. */
#ifndef PALPATE_FIRMWARE_TEST_H
#define PALPATE_FIRMWARE_TEST_H

#include "indenter/device.h"

/* A second at rest, home, a search for an obstacle, then 3 mm down and back; prints a verdict on each check.
 * Returns an exit code: CLI_FAILURE after a bad verdict, CLI_DEVICE_FAULT, without a message, where a fault
 * stopped it. */
int firmware_self_test(const char *name, device *d, bool json);

#endif
