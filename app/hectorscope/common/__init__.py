"""What every part of the application may use: folders, registries, text, compiled code."""
