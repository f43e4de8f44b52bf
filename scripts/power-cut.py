#!/usr/bin/env python3
"""Has an ext4 file system forget what it has not written to its disk, as when the power fails.

    power-cut.py MOUNT_POINT

EXT4_IOC_SHUTDOWN with EXT4_GOING_FLAGS_NOLOGFLUSH (include/uapi/linux/ext4.h): from now on
nothing is written, the journal's running transaction neither. Only for mounts of a test.
"""

import fcntl
import os
import struct
import sys

EXT4_IOC_SHUTDOWN = 0x8004587D
NOLOGFLUSH = 2

if len(sys.argv) != 2:
    sys.exit(__doc__)
folder = os.open(sys.argv[1], os.O_RDONLY)
fcntl.ioctl(folder, EXT4_IOC_SHUTDOWN, struct.pack("I", NOLOGFLUSH))
