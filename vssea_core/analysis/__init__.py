"""Analysis of the sampled closed loop."""
