"""The speed of MORSE, compared with bare MuJoCo loops and other simulators in the same run."""
