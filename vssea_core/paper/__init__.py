"""The paper's simulations and experiments as scenarios with our own numbers, and its sentences as claims that can fail."""
