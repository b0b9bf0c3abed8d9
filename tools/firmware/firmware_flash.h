/* firmware_flash.h: the board's image, written through the chip's own boot loader by the programs that speak
 * with it. */
#ifndef PALPATE_FIRMWARE_FLASH_H
#define PALPATE_FIRMWARE_FLASH_H

/* Writes an image over a serial port by stm32flash, or where port is "dfu" over USB by dfu-util. board: its
 * kind; NULL: that of the firmware in it. image: a file for that kind of board; NULL: the one that came with
 * this program. An exit code, after one line on stderr under name if it is not 0. */
int firmware_flash(const char *name, const char *port, const char *board, const char *image);

#endif
