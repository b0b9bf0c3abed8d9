/* firmware_test.h: the self-test of an indenter, on the bench. */
#ifndef PALPATE_FIRMWARE_TEST_H
#define PALPATE_FIRMWARE_TEST_H

#include "indenter/device.h"

/* A second at rest, then home and 3 mm down and back, with a verdict on each thing that shows; prints them.
 * An exit code: CLI_FAILURE where something is not as it should be, CLI_DEVICE_FAULT where a fault stopped
 * it. */
int firmware_self_test(const char *name, device *d, bool json);

#endif
