"""What an engineer asks, answered with `physics` and `dynamics`."""
