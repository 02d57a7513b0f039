"""One observer after another answers; every answer is on the disk before the next stimulus."""
