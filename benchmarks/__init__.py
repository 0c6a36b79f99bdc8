"""How fast MORSE is: the same work as bare MuJoCo loops and other simulators, in the same run."""
