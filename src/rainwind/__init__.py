"""rainwind: rain-wind induced vibration of stay cables, and a bifurcation toolkit for smooth ODEs."""

__version__ = "0.1.0"
